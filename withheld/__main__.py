"""`python -m withheld ...`"""

import sys

from withheld.cli import main

if __name__ == "__main__":
    sys.exit(main())
