"""Runs a generator in its own interpreter, from Python 3.8 on; ``roadgpt compete sbft`` starts it."""

import sys

if sys.version_info < (3, 8):
    said = "Python %d.%d is too old for RoadGPT's half; 3.8 will do" % sys.version_info[:2]
    sys.stdout.write('{"op": "end", "how": "unasked", "said": "%s"}\n' % said)
    sys.exit(0)

from roadgpt_task import main

main()
