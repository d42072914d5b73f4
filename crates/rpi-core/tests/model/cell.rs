//! A cell with four axes, and the commands of the histories, whose behaviour is controlled by inputs.

use rpi_bench::{NetBuilder, image_compare};
use rpi_core::{Command, Continuity};
use rpi_device::{DeviceBank, Discontinuity, PortId, PortQuery, Quantity, Rejection, ResolveError};
use rpi_image::{Image, Value};
use rpi_lower::LowerOptions;
use rpi_net::{FragmentId, Input, PortRef, ResultKind};
use std::sync::Arc;

pub(crate) const TICK_NS: u64 = 1_000_000;
pub(crate) const AXES: usize = 4;

/// For each kind of command, the axes that it needs and its period in ticks.
pub(crate) const KINDS: [(&[u32], u64); 8] = [
    (&[], 1),
    (&[0], 1),
    (&[1], 1),
    (&[0, 1], 1),
    (&[1, 2], 2),
    (&[0, 3], 1),
    (&[2, 3], 3),
    (&[0], 2),
];

/// Largest change between consecutive steps of an axis that counts as continuous.
pub(crate) const MAX_CONTINUOUS_CHANGE: f64 = 1.0;

/// Axes whose devices a history can make fail.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Axes {
    pub(crate) positions: [f64; AXES],
    pub(crate) moving: [bool; AXES],
    /// Distance that each axis moved with its last set-point.
    pub(crate) steps: [f64; AXES],
    pub(crate) failed: [bool; AXES],
    pub(crate) stops: [u32; AXES],
}

impl Axes {
    pub(crate) const fn new() -> Self {
        Axes {
            positions: [0.0; AXES],
            moving: [false; AXES],
            steps: [0.0; AXES],
            failed: [false; AXES],
            stops: [0; AXES],
        }
    }
}

impl DeviceBank for Axes {
    fn resolve(&mut self, name: &PortQuery<'_>) -> Result<PortId, ResolveError> {
        Ok(PortId(name.index))
    }
    fn resource(&self, port: PortId) -> u32 {
        port.0
    }
    fn read(&mut self, port: PortId, value: &mut [u64]) -> bool {
        value[0] = self.positions[port.0 as usize].to_bits();
        true
    }
    fn check_set_point(&mut self, port: PortId, _: &[u64]) -> Rejection {
        match self.failed[port.0 as usize] {
            true => Rejection::DEVICE_FAILED,
            false => Rejection::NONE,
        }
    }
    fn discontinuity(&self, port: PortId, value: &[u64]) -> Option<Discontinuity> {
        let axis = port.0 as usize;
        let step = f64::from_bits(value[0]) - self.positions[axis];
        let change = step - self.steps[axis];
        (change.abs() > MAX_CONTINUOUS_CHANGE).then_some(Discontinuity {
            resource: port.0,
            quantity: Quantity::Acceleration,
            value: change,
            limit: MAX_CONTINUOUS_CHANGE,
        })
    }
    fn error_code(&self, port: PortId) -> i64 {
        i64::from(self.failed[port.0 as usize])
    }
    fn write(&mut self, port: PortId, value: &[u64]) {
        let (axis, position) = (port.0 as usize, f64::from_bits(value[0]));
        self.moving[axis] = position != self.positions[axis];
        self.steps[axis] = position - self.positions[axis];
        self.positions[axis] = position;
    }
    fn call(&mut self, _: PortId, _: &[u64], _: &mut [u64]) -> bool {
        false
    }
    fn is_moving(&self, resource: u32) -> bool {
        self.moving[resource as usize]
    }
    fn stop(&mut self, resource: u32) {
        self.moving[resource as usize] = false;
        self.steps[resource as usize] = 0.0;
        self.stops[resource as usize] += 1;
    }
}

/// Values of the input `end`.
pub(crate) mod end {
    pub(crate) const FINISH: i64 = 1;
    pub(crate) const YIELD: i64 = 2;
    pub(crate) const FAIL: i64 = 3;
    pub(crate) const FAULT: i64 = 4;
}

/// Keys of the inputs and the export of a command.
pub(crate) const SPEED: &str = "speed";
pub(crate) const END: &str = "end";
pub(crate) const FLAG: &str = "flag";

/// An image that moves its axes by `speed` per cycle, exports `flag`, and ends as the input `end` says.
pub(crate) fn image(kind: usize) -> Arc<Image> {
    let (axes, ticks) = KINDS[kind];
    let root = FragmentId::ROOT;
    let mut b = NetBuilder::new("Puppet");
    let key = |key: &str| [("Key", Value::Str(key.into()))];
    let speed = b.add_with(root, "Core::DoubleNetcommIn", &[], &key(SPEED));
    let how = b.add_with(root, "Core::IntNetcommIn", &[], &key(END));
    let flag = b.add_with(root, "Core::BooleanNetcommIn", &[], &key(FLAG));
    b.add_with(
        root,
        "Core::BooleanNetcommOut",
        &[Input::Port(flag)],
        &key(FLAG),
    );
    axes.iter().for_each(|axis| drive(&mut b, *axis, speed));
    let int = |v: i64| Input::constant(Value::int(v));
    for (name, kind, value) in [
        ("done", ResultKind::Finish, end::FINISH),
        ("early", ResultKind::Yield, end::YIELD),
        ("broken", ResultKind::Fail, end::FAIL),
    ] {
        let is = b.add(root, "Core::IntEquals", &[Input::Port(how), int(value)]);
        b.result(name, kind, is);
    }
    let divisor = b.add(root, "Core::IntAdd", &[Input::Port(how), int(-end::FAULT)]);
    b.add(root, "Core::IntDivide", &[int(1), Input::Port(divisor)]);
    let image = image_compare::lower_net(&b.net, &LowerOptions::running(TICK_NS * ticks));
    Arc::new(image.unwrap_or_else(|e| panic!("{e}")))
}

fn drive(b: &mut NetBuilder, axis: u32, speed: PortRef) {
    let params = [
        ("Robot", Value::Str("arm".into())),
        ("Axis", Value::int(i64::from(axis))),
    ];
    let root = FragmentId::ROOT;
    let place = b.add_with(root, "RobotArm::JointMonitor", &[], &params);
    let target = b.add(
        root,
        "Core::DoubleAdd",
        &[Input::Port(place), Input::Port(speed)],
    );
    b.add_with(
        root,
        "RobotArm::JointPosition",
        &[Input::Port(target)],
        &params,
    );
}

pub(crate) fn load(image: &Arc<Image>, guard: Continuity, bank: &mut Axes) -> Box<Command> {
    let loaded = Command::load(Arc::clone(image), bank);
    let mut command = loaded.unwrap_or_else(|faults| panic!("{faults:?}"));
    command.set_continuity(guard);
    Box::new(command)
}

/// Sets an input by its key.
pub(crate) fn set(command: &mut Command, key: &str, bits: u64) {
    let inputs = &command.instance().image().inputs;
    let index = inputs
        .iter()
        .position(|i| i.key == key)
        .expect("it has this input");
    assert!(command.set_input(index, &[bits]));
}
