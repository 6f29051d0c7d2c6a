"""The gaitlab command's subcommands: what each reads and says; the work is done in other folders."""
