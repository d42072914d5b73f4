//! A light barrier whose beam is interrupted by a script.

use super::{BuildContext, Key, KeyDefault, KeyType, Settings, SmallDevice, script_time};
use crate::cell::quantity::Dimension::Time;
use crate::device::PortRow;
use rpi_image::Scalar::Bool;

/// Light barrier of a simulated cell.
#[derive(Clone, Debug)]
pub(super) struct LightBarrier {
    /// Scripted states of the beam with the times (s) at which they begin: true if the beam is interrupted.
    script: Vec<(f64, bool)>,
    /// Period of the script, in s; infinity if it does not repeat.
    repeat: f64,
    is_interrupted: bool,
}

impl SmallDevice for LightBarrier {
    const KIND: &'static str = "light-barrier";
    const TITLE: &'static str = "light barrier";
    const DEVICE_TYPE: &'static str = "LightBarrier";
    const DESCRIPTION: &'static str = "Its beam is free, except when its script interrupts it.";
    const KEYS: &'static [Key] = &[
        Key::new(
            "script",
            KeyType::Switches,
            KeyDefault::Absent("always free"),
            "a list of `{ at = time, value = interrupted }`",
        ),
        Key::new(
            "repeat",
            KeyType::Positive(Time),
            KeyDefault::Absent("never"),
            "time after which the script restarts",
        ),
    ];
    const PORTS: &'static [PortRow<Self>] =
        &[
            PortRow::<Self>::sensor("interrupted", Bool, |barrier, _, out| {
                out.put_bits(u64::from(barrier.is_interrupted))
            })
            .means("true while something is in the beam"),
        ];

    fn check_settings(settings: &Settings) -> Result<(), (&'static str, String)> {
        let last = settings.switches("script").last().map(|(at, _)| *at);
        match (last, settings.optional("repeat")) {
            (Some(last), Some(repeat)) if last >= repeat => {
                let message = format!(
                    "`repeat` is {repeat} s, expected more than {last} s, the last change of the script"
                );
                Err(("repeat", message))
            }
            _ => Ok(()),
        }
    }

    fn new(settings: &Settings, _context: &BuildContext) -> Self {
        let mut barrier = Self {
            script: settings.switches("script").to_vec(),
            repeat: settings.optional("repeat").unwrap_or(f64::INFINITY),
            is_interrupted: false,
        };
        barrier.step(0.0);
        barrier
    }

    fn step(&mut self, time: f64) {
        let since = script_time(time, self.repeat);
        let past = self.script.iter().take_while(|(at, _)| *at <= since);
        self.is_interrupted = past.last().is_some_and(|(_, value)| *value);
    }
}
