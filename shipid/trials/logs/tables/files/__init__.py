"""Each kind of file as a table: text, Excel, MATLAB, HDF5, Parquet."""
