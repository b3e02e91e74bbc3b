"""`python -m frontal_biped`."""

import sys

from frontal_biped.cli.main import main

sys.exit(main())
