//! Recipes: the variables that the controller and the driver exchange, their types, and their values as bytes.
//!
//! The registers 24 to 47 are those for RTDE clients; those below 24 belong to fieldbuses and safety controllers. Source:
//! RTDE guide, sections "Field names and associated types" and "Data types".

use super::AXES;
use super::error::RtdeError;
use crate::driver_io::Fields;

/// Bits of the counters in registers, which wrap at 2^30: a sum of two still fits a register.
pub(super) const COUNTER_MASK: i32 = (1 << 30) - 1;

/// Joint positions, rad, or velocities, rad/s.
pub(super) type Joints = [f64; AXES];

/// Name and type of a variable.
pub(super) type Variable = (&'static str, &'static str);

/// Variables that the controller sends, in the order of [`Sample::decode`].
pub(super) const OUTPUTS: &[Variable] = &[
    ("timestamp", "DOUBLE"),
    ("actual_q", "VECTOR6D"),
    ("actual_qd", "VECTOR6D"),
    ("target_q", "VECTOR6D"),
    ("robot_mode", "INT32"),
    ("safety_mode", "INT32"),
    ("runtime_state", "UINT32"),
    ("speed_scaling", "DOUBLE"),
    ("target_speed_fraction", "DOUBLE"),
    ("output_int_register_24", "INT32"),
    ("output_int_register_25", "INT32"),
    ("output_int_register_26", "INT32"),
    ("output_int_register_27", "INT32"),
];

/// Variables that the driver sends, in the order of [`Command::encode`].
pub(super) const INPUTS: &[Variable] = &[
    ("input_int_register_24", "INT32"),
    ("input_int_register_25", "INT32"),
    ("input_double_register_24", "DOUBLE"),
    ("input_double_register_25", "DOUBLE"),
    ("input_double_register_26", "DOUBLE"),
    ("input_double_register_27", "DOUBLE"),
    ("input_double_register_28", "DOUBLE"),
    ("input_double_register_29", "DOUBLE"),
];

/// State of the controller at one of its cycles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    /// Time since the start of the controller, in s.
    pub(super) clock: f64,
    /// Measured positions, in rad.
    pub(super) positions: Joints,
    /// Measured velocities, in rad/s.
    pub(super) velocities: Joints,
    /// Positions that the controller commands, in rad.
    pub(super) targets: Joints,
    /// Mode of the robot: 7 while its brakes are released.
    pub(super) robot_mode: i32,
    /// Mode of the safety controller: 1 for normal, 2 for reduced.
    pub(super) safety_mode: i32,
    /// State of the program: 1 stopped, 2 playing, 4 paused.
    pub(super) runtime_state: u32,
    /// Share of the full speed to which the limits of the trajectory scale a running program.
    pub(super) speed_scaling: f64,
    /// Share of the full speed that the operator has set by the speed slider.
    pub(super) speed_fraction: f64,
    /// Phase of the driver's program, as `follow.script` lists them.
    pub(super) phase: i32,
    /// Epoch that the driver's program follows, or has followed last.
    pub(super) epoch: i32,
    /// Number that the driver's program increments in each cycle.
    pub(super) heartbeat: i32,
    /// Token of the program that has written the registers.
    pub(super) token: i32,
}

/// Set-point for the program in the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Command {
    /// Number of the sequence of set-points; 0 if the program must not follow.
    pub(super) epoch: i32,
    /// Number of the set-point. Its increase is the number of cycles since the one before.
    pub(super) number: i32,
    /// Joint positions, in rad.
    pub(super) positions: Joints,
}

/// Returns the names of the variables, with commas between them.
pub(super) fn names(variables: &[Variable]) -> String {
    let names: Vec<&str> = variables.iter().map(|(name, _)| *name).collect();
    names.join(",")
}

/// Compares the answer to a request for these variables with their types. Returns the number of the recipe.
///
/// # Errors
/// Returns the first variable that is unknown, in use, or of another type.
pub(super) fn check_answer(
    variables: &[Variable],
    payload: &[u8],
    kind: u8,
) -> Result<u8, RtdeError> {
    let (recipe, types) = payload
        .split_first()
        .ok_or(RtdeError::MalformedPackage(kind))?;
    let types = core::str::from_utf8(types).map_err(|_| RtdeError::MalformedPackage(kind))?;
    let found: Vec<&str> = types.split(',').map(str::trim).collect();
    for ((name, expected), found) in variables.iter().zip(&found) {
        match *found {
            "NOT_FOUND" => return Err(RtdeError::UnknownVariable(name)),
            "IN_USE" => return Err(RtdeError::VariableInUse(name)),
            found if found != *expected => {
                return Err(RtdeError::VariableType {
                    name,
                    found: found.chars().take(40).collect(),
                    expected,
                });
            }
            _ => {}
        }
    }
    if found.len() != variables.len() {
        return Err(RtdeError::MalformedPackage(kind));
    }
    // Recipe 0 is that of a rejected request.
    match recipe {
        0 => Err(RtdeError::RequestRejected("the list of variables")),
        recipe => Ok(*recipe),
    }
}

impl Fields<'_> {
    fn double(&mut self) -> Option<f64> {
        let value = f64::from_be_bytes(self.take()?);
        value.is_finite().then_some(value)
    }

    fn joints(&mut self) -> Option<Joints> {
        let mut joints = [0.0; AXES];
        for joint in &mut joints {
            *joint = self.double()?;
        }
        Some(joints)
    }

    fn integer(&mut self) -> Option<i32> {
        self.take().map(i32::from_be_bytes)
    }
}

impl Sample {
    /// Decodes the payload of a package with values of [`OUTPUTS`] in the recipe with this number; `None` if the package
    /// belongs to another recipe, has another length, or has a number that is not finite.
    pub(super) fn decode(recipe: u8, payload: &[u8]) -> Option<Self> {
        let mut fields = Fields(payload);
        let [number] = fields.take()?;
        let sample = Self {
            clock: fields.double()?,
            positions: fields.joints()?,
            velocities: fields.joints()?,
            targets: fields.joints()?,
            robot_mode: fields.integer()?,
            safety_mode: fields.integer()?,
            runtime_state: fields.take().map(u32::from_be_bytes)?,
            speed_scaling: fields.double()?,
            speed_fraction: fields.double()?,
            phase: fields.integer()?,
            epoch: fields.integer()?,
            heartbeat: fields.integer()?,
            token: fields.integer()?,
        };
        (number == recipe && fields.0.is_empty()).then_some(sample)
    }
}

impl Command {
    /// Returns the payload of a package with values of [`INPUTS`], in the recipe with this number.
    pub(super) fn encode(&self, recipe: u8) -> Vec<u8> {
        let mut payload = vec![recipe];
        payload.extend(self.epoch.to_be_bytes());
        payload.extend(self.number.to_be_bytes());
        let positions = self.positions.iter();
        positions.for_each(|position| payload.extend(position.to_be_bytes()));
        payload
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes of a sample, as a controller sends them.
    fn bytes(sample: &Sample) -> Vec<u8> {
        let mut bytes = vec![3];
        bytes.extend(sample.clock.to_be_bytes());
        for joints in [sample.positions, sample.velocities, sample.targets] {
            bytes.extend(joints.map(f64::to_be_bytes).concat());
        }
        bytes.extend(sample.robot_mode.to_be_bytes());
        bytes.extend(sample.safety_mode.to_be_bytes());
        bytes.extend(sample.runtime_state.to_be_bytes());
        bytes.extend(sample.speed_scaling.to_be_bytes());
        bytes.extend(sample.speed_fraction.to_be_bytes());
        for register in [sample.phase, sample.epoch, sample.heartbeat, sample.token] {
            bytes.extend(register.to_be_bytes());
        }
        bytes
    }

    fn sample() -> Sample {
        Sample {
            clock: 12.5,
            positions: [0.1, -0.2, 0.3, -0.4, 0.5, -0.6],
            velocities: [1.0; AXES],
            targets: [0.5; AXES],
            robot_mode: -1,
            safety_mode: 3,
            runtime_state: 2,
            speed_scaling: 1.0,
            speed_fraction: 0.5,
            phase: 1,
            epoch: 5,
            heartbeat: 100,
            token: 0x5250_0001,
        }
    }

    #[test]
    fn a_sample_is_read_as_it_was_written() {
        assert_eq!(Sample::decode(3, &bytes(&sample())), Some(sample()));
        assert_eq!(Sample::decode(4, &bytes(&sample())), None);
    }

    #[test]
    fn damaged_samples_are_rejected() {
        let whole = bytes(&sample());
        assert!((0..whole.len()).all(|end| Sample::decode(3, &whole[..end]).is_none()));
        let longer = [&whole[..], &[0]].concat();
        assert_eq!(Sample::decode(3, &longer), None);
        for at in 1..whole.len() {
            let mut damaged = whole.clone();
            damaged[at] ^= 0xff;
            let read = Sample::decode(3, &damaged);
            assert!(read.is_none_or(|sample| sample.positions.iter().all(|q| q.is_finite())));
        }
    }

    #[test]
    fn a_command_has_the_layout_of_its_recipe() {
        let command = Command {
            epoch: 1,
            number: -2,
            positions: sample().positions,
        };
        let payload = command.encode(9);
        assert_eq!(payload.len(), 1 + 2 * 4 + AXES * 8);
        assert_eq!(payload[..9], [9, 0, 0, 0, 1, 0xff, 0xff, 0xff, 0xfe]);
        assert_eq!(payload[9..17], 0.1_f64.to_be_bytes());
    }

    #[test]
    fn answers_with_unknown_used_or_other_variables_are_errors() {
        let check = |answer: &str| {
            let payload = [&[1], answer.as_bytes()].concat();
            check_answer(&INPUTS[..3], &payload, b'I')
        };
        assert_eq!(check("INT32,INT32,DOUBLE").unwrap(), 1);
        let message = |answer| check(answer).unwrap_err().to_string();
        assert!(message("INT32,NOT_FOUND,DOUBLE").contains("no variable `input_int_register_25`"));
        assert!(message("IN_USE,INT32,DOUBLE").contains("client of the controller writes"));
        assert!(message("INT32,INT32,VECTOR3D").contains("expected `DOUBLE`"));
        assert!(message("INT32,INT32").contains("`I`"));
        assert!(check_answer(&INPUTS[..1], b"\0INT32", b'I').is_err());
        assert!(check_answer(&INPUTS[..1], b"", b'I').is_err());
        assert!(check_answer(&INPUTS[..1], b"\x01\xff\xff", b'I').is_err());
    }
}
