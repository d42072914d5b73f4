//! Command on the server that moves the arm as the keys ask.

use std::error::Error;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use rpi_client::{Client, Feedback, Goal, OnLoss, Program, Session};
use rpi_sim::TaughtPose;

/// Program of the command; `$arm` and `$type` stand for the name and the type of the arm.
const PROGRAM: &str = include_str!("jog.rpi");

/// Period of a tick of the server, in ns, for which the time after a key is counted.
const TICK_NS: u64 = 1_000_000;
/// Time in which the arm must come to rest.
const REST_TIME: Duration = Duration::from_secs(10);
/// Time between two looks at the state of the arm.
const LOOK: Duration = Duration::from_millis(5);

/// Speeds of the tool (m/s) from which the keys choose. The angular velocity in rad/s is four times that.
const SPEEDS: [f64; 6] = [0.002, 0.01, 0.025, 0.05, 0.1, 0.25];
/// Angular velocity of the tool or of an axis (rad/s) for each m/s of the speed of the tool.
const TURN: f64 = 4.0;

/// Motion that a key asks for, or a choice for the next ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Motion {
    /// Moves the tool: component of the velocity (x, y, z, and rotations about them) and sign.
    Tool {
        component: usize,
        sign: f64,
    },
    /// Turns the chosen axis.
    Axis {
        sign: f64,
    },
    /// Chooses the axis, from 0.
    ChooseAxis(usize),
    Faster,
    Slower,
}

/// Place of the arm: joint positions and pose of the tool in the base.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Place {
    /// Joint positions, rad.
    pub(super) joints: Vec<f64>,
    /// Pose of the tool in the base of the arm.
    pub(super) pose: TaughtPose,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.pose.position.map(|length| length * 1e3);
        write!(f, "x {x:.1} mm, y {y:.1} mm, z {z:.1} mm")
    }
}

/// Arm that moves as keys ask. A motion ends by itself if no further key follows, also if this process ends.
pub(super) struct ArmJog {
    session: Session,
    program: Program,
    /// Running command; `None` after an error of the arm, until the next key.
    goal: Option<Goal>,
    /// Number of the last key.
    key: u64,
    /// Number of ticks for which the arm moves after a key.
    hold: u64,
    axis: usize,
    speed: usize,
}

impl ArmJog {
    /// Starts the command on the server. `arm` is the name of the arm with its type, and `hold` the time in ns for which the
    /// arm moves after each key.
    ///
    /// # Errors
    /// Returns the error of the server, such as an arm that another command holds.
    pub(super) fn new(
        client: &Client,
        (arm, ty): &(String, String),
        hold: u64,
    ) -> Result<ArmJog, Box<dyn Error>> {
        let text = PROGRAM.replace("$arm", arm).replace("$type", ty);
        let mut jog = ArmJog {
            session: client.open_session("teach", OnLoss::Cancel)?,
            program: Program::new(text),
            goal: None,
            key: 0,
            hold: hold.div_ceil(TICK_NS).max(1),
            axis: 0,
            speed: 3,
        };
        jog.start()?;
        Ok(jog)
    }

    fn start(&mut self) -> Result<(), Box<dyn Error>> {
        let goal = self.session.load(&self.program)?;
        goal.start()?;
        self.goal = Some(goal);
        Ok(())
    }

    /// Carries out the motion of a key. After an error of the arm, the command is started again.
    pub(super) fn press(&mut self, motion: &Motion) -> Result<(), Box<dyn Error>> {
        let last = SPEEDS.len() - 1;
        match motion {
            Motion::ChooseAxis(axis) => self.choose(*axis)?,
            Motion::Faster => self.set_speed((self.speed + 1).min(last)),
            Motion::Slower => self.set_speed(self.speed.saturating_sub(1)),
            Motion::Tool { component, sign } => {
                let speed = sign * SPEEDS[self.speed];
                let mut velocity = [0.0; 6];
                velocity[*component] = if *component < 3 { speed } else { TURN * speed };
                self.send(false, velocity, 0.0)?;
            }
            Motion::Axis { sign } => self.send(true, [0.0; 6], sign * TURN * SPEEDS[self.speed])?,
        }
        Ok(())
    }

    fn choose(&mut self, axis: usize) -> Result<(), Box<dyn Error>> {
        let axes = self.place()?.joints.len();
        if axis < axes {
            self.axis = axis;
            rpi_diag::println_stderr!("axis {}", axis + 1);
        } else {
            rpi_diag::println_stderr!("the arm has {axes} axes");
        }
        Ok(())
    }

    fn set_speed(&mut self, speed: usize) {
        self.speed = speed;
        let [tool, turn] = [1e3 * SPEEDS[speed], (TURN * SPEEDS[speed]).to_degrees()];
        rpi_diag::println_stderr!("{tool:.0} mm/s, {turn:.1} deg/s");
    }

    fn send(&mut self, by_axis: bool, velocity: [f64; 6], turn: f64) -> Result<(), Box<dyn Error>> {
        if self.ended()? {
            self.start()?;
        }
        let Some(goal) = &self.goal else {
            return Ok(());
        };
        self.key += 1;
        let names = ["x", "y", "z", "a", "b", "c"];
        let tool = names
            .into_iter()
            .zip(velocity.map(|value| format!("{value:?}")));
        let others = [
            ("turn", format!("{turn:?}")),
            ("axis", self.axis.to_string()),
            ("by_axis", by_axis.to_string()),
            ("hold", self.hold.to_string()),
            ("key", self.key.to_string()),
        ];
        let all: Vec<(&str, String)> = tool.chain(others).collect();
        Ok(goal.set_inputs(all.iter().map(|(name, value)| (*name, value.as_str())))?)
    }

    /// Returns whether the command has ended, because of an error of the arm. Tells the user so.
    fn ended(&mut self) -> Result<bool, Box<dyn Error>> {
        let Some(goal) = &self.goal else {
            return Ok(true);
        };
        if goal.present()?.state != "terminated" {
            return Ok(false);
        }
        if let Some(goal) = self.goal.take() {
            let ending = goal.result()?;
            let why = ending
                .why
                .unwrap_or_else(|| format!("error {}", ending.error));
            rpi_diag::println_stderr!("the arm stopped: {why}");
            goal.unload()?;
        }
        Ok(true)
    }

    /// Returns the place of the arm.
    ///
    /// # Errors
    /// Returns an error if the connection is closed.
    pub(super) fn place(&mut self) -> Result<Place, Box<dyn Error>> {
        if self.goal.is_none() {
            self.start()?;
        }
        let begin = Instant::now();
        while begin.elapsed() < REST_TIME {
            let goal = self.goal.as_ref().ok_or("the command has ended")?;
            if let Some(place) = place_of(&goal.present()?) {
                return Ok(place);
            }
            thread::sleep(LOOK);
        }
        Err("the arm does not report its place".into())
    }

    /// Waits until the arm rests after the last key, or its command has ended.
    ///
    /// # Errors
    /// Returns an error if the connection is closed, or the arm does not come to rest.
    pub(super) fn wait_for_rest(&mut self, interrupted: &AtomicBool) -> Result<(), Box<dyn Error>> {
        let begin = Instant::now();
        while begin.elapsed() < REST_TIME {
            if interrupted.load(Ordering::Relaxed) || self.ended()? {
                return Ok(());
            }
            if let Some(goal) = &self.goal {
                let now = goal.present()?;
                let is = |name: &str, value: &str| now.values.get(name).is_some_and(|v| v == value);
                if is("jog_key", &self.key.to_string()) && is("jog_rests", "true") {
                    return Ok(());
                }
            }
            thread::sleep(LOOK);
        }
        Err("the arm does not come to rest".into())
    }

    /// Stops the arm on its path and ends the command.
    ///
    /// # Errors
    /// Returns an error if the connection is closed.
    pub(super) fn close(&mut self) -> Result<(), Box<dyn Error>> {
        if self.ended()? {
            return Ok(());
        }
        if let Some(goal) = self.goal.take() {
            goal.preempt()?;
            goal.result()?;
        }
        Ok(())
    }
}

/// Returns the place that the command exports; `None` before its first cycle.
fn place_of(now: &Feedback) -> Option<Place> {
    let text = |name: &str| now.values.get(name).map(String::as_str);
    let joint = |axis: usize| text(&format!("jog_joints[{axis}]"))?.parse().ok();
    let joints: Vec<f64> = (0..).map_while(joint).collect();
    let pose = TaughtPose {
        position: vector(text("jog_position")?)?,
        rotation: vector(text("jog_rotation")?)?,
    };
    (!joints.is_empty()).then_some(Place { joints, pose })
}

/// Returns the components of an exported vector, such as `{x:1.0,y:2.0,z:3.0}`.
fn vector(text: &str) -> Option<[f64; 3]> {
    let inner = text.strip_prefix('{')?.strip_suffix('}')?;
    let number = |part: &str| part.rsplit(':').next()?.parse().ok();
    let numbers: Option<Vec<f64>> = inner.split(',').map(number).collect();
    numbers?.try_into().ok()
}
