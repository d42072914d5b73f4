//! Running a command on a clock: simulated and real time, recording, replay against traces, plots.
