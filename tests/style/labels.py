"""Every test that CTest knows has exactly one of the four labels, or nightly, of tests/CMakeLists.txt.

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
    of_four = LABELS.intersection(labels)
    if len(of_four) == 1:
        count[of_four.pop()] += 1
    else:
        wrong.append(f"{test['name']}: {', '.join(labels) or 'no label'}")
if wrong:
    sys.exit("Each test needs one of " + ", ".join(count) + " (tests/CMakeLists.txt says which):\n  " + "\n  ".join(wrong))
print(", ".join(f"{n} {label}" for label, n in count.items()))
