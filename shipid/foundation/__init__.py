"""What every room uses: errors, exit codes, number formats, statistics, atomic writing of files, the cache folder."""
