"""`python -m frontal_biped`."""

import sys

from frontal_biped.cli import main

sys.exit(main())
