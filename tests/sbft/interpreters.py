"""Other Pythons of this machine, for what runs in a generator's interpreter."""

import os
import re
import shutil
import subprocess
from pathlib import Path


def old_pythons() -> list[str]:
    """Interpreters of Python 3.8 to 3.10, the oldest first; those that do not start are left out."""
    found = {version: shutil.which(f"python3.{version}") for version in (8, 9, 10)}
    kept = os.environ.get("PYENV_ROOT") or str(Path.home() / ".pyenv")
    for path in Path(kept, "versions").glob("3.*/bin/python"):
        version = re.match(r"3\.(\d+)\.", path.parts[-3])
        if version and int(version[1]) in found:
            found[int(version[1])] = str(path)
    return [path for _, path in sorted(found.items()) if path and starts(path)]


def starts(path: str) -> bool:
    done = subprocess.run([path, "-c", "print(7)"], capture_output=True, text=True, check=False)
    return done.stdout.strip() == "7"
