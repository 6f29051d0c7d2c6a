"""When frames were seen and keys were pressed, how sure that is, and the certificate that says so."""
