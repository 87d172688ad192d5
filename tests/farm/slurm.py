"""A Slurm of four nodes on this machine, for a test: of Debian's packages, on ports that are free, ended with the object."""

import os
import pathlib
import shutil
import signal
import socket
import subprocess
import time

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol")


def why_not():
    """Why none can be started here; empty: it can."""
    os.environ["PATH"] += ":/usr/sbin:/sbin"
    missing = [name for name in PROGRAMS if not shutil.which(name)]
    if missing:
        return f"{', '.join(missing)} aren't here (Debian: slurmctld slurmd slurm-client munge)"
    return "" if os.geteuid() == 0 else "its daemons change users, which root alone may"


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


class Slurm:
    """In a new folder, whose parents others may enter. Nodes node1 … node4 of one core each; what is begun again waits seconds."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.processes = {}
        for name in ("state", "spool", "munge"):
            (self.folder / name).mkdir()
        key = self.folder / "munge/key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        host, ports = socket.gethostname().split(".")[0], free_ports(5)
        self.configuration = self.folder / "slurm.conf"
        self.configuration.write_text("\n".join([
            "ClusterName=test", f"SlurmctldHost={host}(127.0.0.1)", f"SlurmctldPort={ports[0]}", "SlurmUser=root", "SlurmdUser=root",
            # A task that is begun again waits until its last credential has expired.
            "AuthType=auth/munge", f"AuthInfo=socket={self.folder}/munge/socket,cred_expire=5", "CredType=cred/munge",
            f"StateSaveLocation={self.folder}/state", f"SlurmdSpoolDir={self.folder}/spool/%n",
            f"SlurmctldPidFile={self.folder}/slurmctld.pid", f"SlurmdPidFile={self.folder}/slurmd.%n.pid",
            "ProctrackType=proctrack/linuxproc", "TaskPlugin=task/none", "MpiDefault=none", "SwitchType=switch/none",
            "JobAcctGatherType=jobacct_gather/none", "AccountingStorageType=accounting_storage/none",
            "SelectType=select/cons_tres", "SelectTypeParameters=CR_Core_Memory", "SchedulerType=sched/backfill",
            "SchedulerParameters=bf_interval=2,sched_interval=2", "ReturnToService=2", "SlurmdParameters=config_overrides",
            "KillWait=3", "JobRequeue=1", "SlurmdTimeout=20", "MessageTimeout=5",
            f"NodeName=node[1-4] NodeHostname={host} NodeAddr=127.0.0.1 Port=[{','.join(map(str, ports[1:]))}] CPUs=1 RealMemory=2000",
            "PartitionName=farm Nodes=node[1-4] Default=YES MaxTime=INFINITE State=UP"]) + "\n")
        os.environ["SLURM_CONF"] = str(self.configuration)

    def __enter__(self):
        try:
            munge = self.folder / "munge"
            self._start("munged", "munged", "--foreground", "--force", f"--key-file={munge}/key", f"--socket={munge}/socket",
                        f"--pid-file={munge}/pid", f"--seed-file={munge}/seed", f"--log-file={munge}/log")
            self._until(lambda: (munge / "socket").exists(), 10, "munged")
            self.start_controller()
            for node in range(1, 5):
                self._start(f"node{node}", "slurmd", "-D", "-N", f"node{node}", "-f", self.configuration)
            self._until(lambda: self("sinfo", "-h", "-o", "%t %D", check=False).split() == ["idle", "4"], 30, "four idle nodes")
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        # Jobs first: their processes aren't ours.
        if (self.folder / "munge/socket").exists():
            self("scancel", "--full", "--signal=KILL", "--user=root", check=False)
            time.sleep(0.5)
        for name in reversed(list(self.processes)):
            self.stop(name)

    def __call__(self, *command, check=True):
        """What a command of Slurm's says."""
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=60)
        if check and done.returncode:
            raise RuntimeError(f"{command}: {done.stderr}")
        return done.stdout

    def start_controller(self):
        self._start("slurmctld", "slurmctld", "-D", "-f", self.configuration)

    def stop(self, name, number=signal.SIGTERM):
        process = self.processes.pop(name)
        process.send_signal(number)
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()

    def wait(self, seconds):
        """Until no job is left."""
        self._until(lambda: not self("squeue", "-h"), seconds, "the end of all jobs", lambda: self("squeue"))

    def _start(self, name, *command):
        with open(self.folder / f"{name}.log", "ab") as log:
            self.processes[name] = subprocess.Popen(list(map(str, command)), stdin=subprocess.DEVNULL, stdout=log, stderr=log)

    def _until(self, there, seconds, what, words=lambda: ""):
        end = time.monotonic() + seconds
        while not there():
            if time.monotonic() > end:
                logs = "".join(f"== {log.name}\n{log.read_text(errors='replace')[-2000:]}" for log in self.folder.glob("*.log"))
                raise RuntimeError(f"no {what} in {seconds} s\n{words()}{logs}")
            time.sleep(0.1)
