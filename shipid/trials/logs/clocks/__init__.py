"""The clock of a log, however it is written: text, dates, epochs, serial days, time stamps of pandas, time of the GPS week."""
