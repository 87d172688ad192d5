// A job type for Flamenco 3: the tasks of a script that `pelagic farm` has written, and then the check of its folder.
const JOB_TYPE = {
    label: "Pelagic",
    settings: [
        { key: "script", type: "string", required: true, description: "DIR/farm/NAME.bake.sh or NAME.render.sh" },
        { key: "tasks", type: "int32", required: true, description: "how many tasks it has" },
    ]
};

function compileJob(job) {
    const { script, tasks } = job.settings;
    const run = (name, args) => {
        const task = author.Task(name, "misc");
        task.addCommand(author.Command("exec", { exe: "/bin/bash", args: args }));
        return task;
    };
    const verify = run("verify", [script.replace(/\.sh$/, ".verify.sh")]);
    for (let n = 0; n < tasks; n++) {
        const task = run(`task ${n}`, [script, String(n)]);
        verify.addDependency(task);
        job.addTask(task);
    }
    job.addTask(verify);
}
