"""`python -m gonio` is `gonio`."""

from gonio.cli import main

main()
