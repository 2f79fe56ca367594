"""NMEA 0183 logs as trials: lines, sentences, clock, channels, one common clock.

`shipid.read_trial` comes here for ``format="nmea"`` and for a format file with a table ``[nmea]``
(`shipid.trials.logs.nmea.settings`). The flow is the list of files: ``lines`` (text to sentences), ``sentences`` (what
each one carries), ``log`` (the whole file), ``clock`` (when each line was), ``sources`` (which sentence and talker is
taken for what), ``channels`` (units, signs, reference points), ``resampling`` (one clock for all), ``reading``
(all of it), and ``writing`` (the way back).
"""
