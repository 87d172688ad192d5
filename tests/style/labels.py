"""Every test that CTest knows has exactly one of the labels of tests/CMakeLists.txt.

    labels.py CTEST BUILD-FOLDER
"""

import json
import subprocess
import sys

LABELS = {"unit", "slow", "gl", "external", "nightly"}

ctest, build = sys.argv[1:]
listed = subprocess.run([ctest, "--test-dir", build, "--show-only=json-v1"], check=True, capture_output=True, text=True)
tests = json.loads(listed.stdout)["tests"]
if not tests:
    sys.exit(f"{ctest} lists no test in {build}")
count = dict.fromkeys(sorted(LABELS), 0)
wrong = []
for test in tests:
    labels = next((p["value"] for p in test.get("properties", []) if p["name"] == "LABELS"), [])
    of_them = LABELS.intersection(labels)
    if len(of_them) == 1:
        count[of_them.pop()] += 1
    else:
        wrong.append(f"{test['name']}: {', '.join(labels) or 'no label'}")
if wrong:
    sys.exit("Each test needs one of " + ", ".join(count) + " (tests/CMakeLists.txt says which):\n  " + "\n  ".join(wrong))
print(", ".join(f"{n} {label}" for label, n in count.items()))
