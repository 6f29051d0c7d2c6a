"""What other recorders are told, and when: markers over Lab Streaming Layer, and trigger pulses."""
