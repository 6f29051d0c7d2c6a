"""Study files shipped with gaitlab."""
