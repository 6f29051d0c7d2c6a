"""What a study file will be, before a participant sits down: what is wrong with it, its balance, its length."""
