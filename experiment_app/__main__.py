"""`python -m experiment_app` is the gaitlab command."""

from experiment_app.command import main

main()
