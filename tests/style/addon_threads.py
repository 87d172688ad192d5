"""The add-on runs no Python in threads of its own, nor callables that others would call from theirs: why is said in
addon/pelagic_ocean/sea.py.

    addon_threads.py FOLDER
"""

import ast
import sys
from pathlib import Path

STARTERS = {"Thread", "Timer", "start_new_thread", "ThreadPool", "ThreadPoolExecutor", "Executor", "to_thread",
            "run_in_executor"}
CALLED_BACK = {"progress", "cancel"}  # arguments of the module's that it calls from any thread


def faults(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        named = {ast.Name: "id", ast.Attribute: "attr", ast.alias: "name"}.get(type(node))
        name = getattr(node, named).rpartition(".")[2] if named else None
        if name in STARTERS:
            yield getattr(node, "lineno", 0), f"{name} runs Python in a thread; accepted: a pelagic.Task"
        if isinstance(node, ast.Call):
            for keyword in node.keywords:
                if keyword.arg in CALLED_BACK:
                    yield node.lineno, f"{keyword.arg}= is called from any thread; accepted: a pelagic.Task, polled"


found = [(path, line, what) for path in sorted(Path(sys.argv[1]).rglob("*.py")) for line, what in faults(path)]
for path, line, what in found:
    print(f"{path}:{line}: {what}")
sys.exit(bool(found))
