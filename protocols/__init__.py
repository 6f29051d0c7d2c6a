"""What to show when: study files, designs, tasks as pure state machines, records of trials."""
