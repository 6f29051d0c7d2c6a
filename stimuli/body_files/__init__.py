"""Bodies in files: glTF 2.0 binary containers, their arrays, and the bodies gaitlab bakes itself."""
