"""What the gaitlab command's subcommands do; heavy imports stay inside them."""
