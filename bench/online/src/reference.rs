//! Runs the Python package `ruckig` on a list of requests.

use rpi_motion::online::Synchronization;
use std::io::Write;
use std::process::Command;

use crate::cases::Case;

/// Motion that the Python package `ruckig` computed for a request.
#[derive(Clone, Copy, Debug)]
pub struct Reference {
    /// True if `ruckig` found a motion.
    pub is_planned: bool,
    /// Duration of the motion that `ruckig` computed, in seconds.
    pub duration: f64,
    /// Largest deviations of the motion from the target at its end, over all axes: position, velocity and acceleration.
    /// That of the velocity includes the excess over the velocity limits, relative to the limit.
    pub errors: [f64; 3],
    /// Time that `ruckig` needed to compute the motion, in seconds.
    pub calculation: f64,
}

/// Request for a motion of one or several axes, with the kind of synchronisation and the minimum duration.
pub struct Request<'a> {
    /// Start, target and limits of each axis.
    pub axes: &'a [Case],
    /// Kind of synchronisation of the axes: none, by time (the axes end at the same time) or by phase.
    pub synchronization: Synchronization,
    /// Time in seconds before which the motion must not end; 0 for no such time.
    pub minimum_duration: f64,
}

impl Request<'_> {
    fn append(&self, numbers: &mut Vec<f64>) {
        let synchronization = match self.synchronization {
            Synchronization::None => 0.0,
            Synchronization::Time => 1.0,
            Synchronization::Phase => 2.0,
        };
        let interface = if self.axes[0].is_velocity { 1.0 } else { 0.0 };
        numbers.extend([
            self.axes.len() as f64,
            interface,
            synchronization,
            self.minimum_duration,
        ]);
        for Case {
            start,
            target,
            limits,
            ..
        } in self.axes
        {
            numbers.extend([
                start.position,
                start.velocity,
                start.acceleration,
                target.position,
                target.velocity,
                target.acceleration,
                limits.max_velocity,
                limits.min_velocity,
                limits.max_acceleration,
                limits.min_acceleration,
                limits.max_jerk,
            ]);
        }
    }
}

/// Returns the motions that `ruckig` computes for the requests, in the same order. If the package is not installed,
/// prints a message and returns `None`.
pub fn run<'a>(requests: impl Iterator<Item = Request<'a>>) -> Option<Vec<Reference>> {
    let python = std::env::var("RPI_PYTHON").unwrap_or_else(|_| "python3".into());
    let probe = Command::new(&python).args(["-c", "import ruckig"]).output();
    if !probe.is_ok_and(|output| output.status.success()) {
        eprintln!("SKIPPED: {python} cannot import ruckig (pip install ruckig, RPI_PYTHON=...)");
        return None;
    }
    let mut numbers = Vec::new();
    requests.for_each(|request| request.append(&mut numbers));
    let file =
        |name: &str| std::env::temp_dir().join(format!("rpi-online-{}-{name}", std::process::id()));
    let (input, output) = (file("requests"), file("results"));
    let bytes: Vec<u8> = numbers
        .iter()
        .flat_map(|number| number.to_le_bytes())
        .collect();
    std::fs::write(&input, bytes).expect("the temporary folder is writable");
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/ruckig_reference.py");
    _ = std::fs::remove_file(&output);
    // The package crashes on some requests (version 0.19.4); these count as errors.
    loop {
        let status = Command::new(&python)
            .arg(script)
            .args([&input, &output])
            .status();
        let status = status.expect("the interpreter runs");
        if status.success() {
            break;
        }
        assert!(status.code().is_none(), "the script failed: {status}");
        let mut file = std::fs::OpenOptions::new()
            .append(true)
            .create(true)
            .open(&output)
            .expect("the temporary folder is writable");
        file.write_all(&[0; 48])
            .expect("the temporary folder is writable");
    }
    let bytes = std::fs::read(&output).expect("the script has written its results");
    let rows = bytes.chunks_exact(48).map(|row| {
        let number =
            |k: usize| f64::from_le_bytes(row[8 * k..8 * k + 8].try_into().expect("8 bytes"));
        Reference {
            is_planned: number(0) > 0.5,
            duration: number(1),
            errors: [number(2), number(3), number(4)],
            calculation: number(5),
        }
    });
    let results = rows.collect();
    for path in [input, output] {
        if std::env::var("RPI_KEEP").is_err() {
            _ = std::fs::remove_file(path);
        }
    }
    Some(results)
}
