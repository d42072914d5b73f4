//! Test axes that move directly to their set-points, and commands for them.
#![allow(dead_code, unreachable_pub)]

use rpi_bench::{NetBuilder, image_compare, net_builder};
use rpi_core::{Command, CommandError, CommandId, Core, Rule};
use rpi_device::{DeviceBank, Discontinuity, PortId, PortQuery, Quantity, Rejection, ResolveError};
use rpi_image::Value;
use rpi_lower::LowerOptions;
use rpi_net::{FragmentId, Input, Net, PortRef, ResultKind};

pub const MS: u64 = 1_000_000;
pub const ROOT: FragmentId = FragmentId::ROOT;

/// Four axes. An axis is moving if its last set-point differs from the previous one.
#[derive(Clone, Default)]
pub struct Axes {
    pub positions: [f64; 4],
    pub moving: [bool; 4],
    /// Distance that each axis moved with its last set-point.
    pub steps: [f64; 4],
    /// Set-points with their axes, in order, up to the capacity.
    pub log: Vec<(u32, f64)>,
    pub stops: [u32; 4],
    /// Period of the command that started last on each axis, in ticks.
    pub paces: [u32; 4],
    pub failed: bool,
}

impl Axes {
    pub fn new() -> Self {
        Axes {
            log: Vec::with_capacity(4096),
            ..Axes::default()
        }
    }

    pub fn set_points(&self, axis: u32) -> Vec<f64> {
        self.log
            .iter()
            .filter(|l| l.0 == axis)
            .map(|l| l.1)
            .collect()
    }
}

impl DeviceBank for Axes {
    fn resolve(&mut self, name: &PortQuery<'_>) -> Result<PortId, ResolveError> {
        match (name.device, name.index) {
            ("arm", index @ 0..4) => Ok(PortId(index)),
            ("arm", _) => Err(ResolveError::IndexOutOfRange),
            _ => Err(ResolveError::UnknownDevice),
        }
    }
    fn resource(&self, port: PortId) -> u32 {
        port.0
    }
    fn begin_command(&mut self, resource: u32, ticks: u32) {
        self.paces[resource as usize] = ticks;
    }
    fn read(&mut self, port: PortId, value: &mut [u64]) -> bool {
        value[0] = self.positions[port.0 as usize].to_bits();
        true
    }
    fn check_set_point(&mut self, _: PortId, value: &[u64]) -> Rejection {
        match (self.failed, f64::from_bits(value[0]).is_nan()) {
            (true, _) => Rejection::DEVICE_FAILED,
            (_, true) => Rejection::ILLEGAL_VALUE,
            _ => Rejection::NONE,
        }
    }
    /// A step is discontinuous if it differs by more than 2 mm from the previous one.
    fn discontinuity(&self, port: PortId, value: &[u64]) -> Option<Discontinuity> {
        let axis = port.0 as usize;
        let step = f64::from_bits(value[0]) - self.positions[axis];
        let change = step - self.steps[axis];
        (change.abs() > 2e-3).then_some(Discontinuity {
            resource: port.0,
            quantity: Quantity::Acceleration,
            value: change,
            limit: 2e-3,
        })
    }
    fn error_code(&self, _: PortId) -> i64 {
        i64::from(self.failed)
    }
    fn write(&mut self, port: PortId, value: &[u64]) {
        let (axis, position) = (port.0 as usize, f64::from_bits(value[0]));
        self.moving[axis] = position != self.positions[axis];
        self.steps[axis] = position - self.positions[axis];
        self.positions[axis] = position;
        if self.log.len() < self.log.capacity() {
            self.log.push((port.0, position));
        }
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

/// A command that moves one axis by a millimetre per cycle from its present position, for `cycles` cycles. It finishes
/// as `done` one cycle later, and may yield as `early` from cycle `yields` on.
pub fn mover(axis: i64, cycles: u32, yields: u32) -> Net {
    let mut b = NetBuilder::new("Mover");
    let steps = mover_flow(&mut b, axis, f64::from(cycles) * 1e-3);
    let done = over(&mut b, steps, f64::from(cycles) + 0.5);
    let early = over(&mut b, steps, f64::from(yields) - 0.5);
    b.result("done", ResultKind::Finish, done);
    b.result("early", ResultKind::Yield, early);
    b.net
}

/// A command that moves one axis by half a metre in one step.
pub fn leaper(axis: i64) -> Net {
    let mut b = NetBuilder::new("Leaper");
    let params = [
        ("Robot", Value::Str("arm".into())),
        ("Axis", Value::int(axis)),
    ];
    let place = b.add_with(ROOT, "RobotArm::JointMonitor", &[], &params);
    let inputs = [Input::Port(place), net_builder::real(0.5)];
    let target = b.add(ROOT, "Core::DoubleAdd", &inputs);
    b.add_with(
        ROOT,
        "RobotArm::JointPosition",
        &[Input::Port(target)],
        &params,
    );
    b.net
}

/// Sets an axis to its start position plus the smaller of the cycle number in mm and `most`. Returns the cycle number,
/// from 1.
pub fn mover_flow(b: &mut NetBuilder, axis: i64, most: f64) -> PortRef {
    let params = [
        ("Robot", Value::Str("arm".into())),
        ("Axis", Value::int(axis)),
    ];
    let place = b.add_with(ROOT, "RobotArm::JointMonitor", &[], &params);
    let first = b.add(ROOT, "Rpi::First", &[]);
    let start_before = b.add(ROOT, "Rpi::DoublePre", &[]);
    let inputs = [first, place, start_before].map(Input::Port);
    let start = b.add(ROOT, "Core::DoubleConditional", &inputs);
    b.wire(start_before.node, 0, start);
    let time = b.add(ROOT, "Core::Clock", &[]);
    let travel = b.add(
        ROOT,
        "Rpi::DoubleMinimum",
        &[Input::Port(time), net_builder::real(most)],
    );
    let target = b.add(
        ROOT,
        "Core::DoubleAdd",
        &[Input::Port(start), Input::Port(travel)],
    );
    b.add_with(
        ROOT,
        "RobotArm::JointPosition",
        &[Input::Port(target)],
        &params,
    );
    b.add(
        ROOT,
        "Core::DoubleMultiply",
        &[Input::Port(time), net_builder::real(1000.0)],
    )
}

pub fn over(b: &mut NetBuilder, flow: PortRef, limit: f64) -> PortRef {
    b.add(
        ROOT,
        "Core::DoubleGreater",
        &[Input::Port(flow), net_builder::real(limit)],
    )
}

pub fn load(net: &Net, bank: &mut Axes) -> Box<Command> {
    load_for(MS, net, bank)
}

/// Loads a net as a command with this period.
pub fn load_for(period_ns: u64, net: &Net, bank: &mut Axes) -> Box<Command> {
    let image = image_compare::lower_net(net, &LowerOptions::running(period_ns))
        .expect("it can be lowered");
    Box::new(
        Command::load(image, bank)
            .map_err(|f| format!("{f:?}"))
            .expect("it loads"),
    )
}

/// A core with capacity for four commands that holds these commands.
pub fn core(nets: &[Net], bank: &mut Axes) -> (Core, Vec<CommandId>) {
    let mut core = Core::with_capacity(4, MS);
    let ids = nets
        .iter()
        .map(|net| core.insert(load(net, bank)).map_err(|e| e.1).expect("room"));
    let ids = ids.collect();
    (core, ids)
}

/// Runs ticks with allocations forbidden.
pub fn ticks(core: &mut Core, bank: &mut Axes, count: u64) {
    rpi_testkit::no_alloc(|| {
        for _ in 0..count {
            let wall_ns = (core.now() * MS).cast_signed();
            core.tick(bank, wall_ns, &mut ());
        }
    });
}

/// Schedules a command after another one.
pub fn follow(
    core: &mut Core,
    next: CommandId,
    after: CommandId,
    kept: bool,
    bank: &mut Axes,
) -> Result<(), CommandError> {
    let rule = Rule::follow(after).start(next);
    let rule = if kept { rule.keep_orphans() } else { rule };
    let made = core.schedule(Box::new(rule), bank);
    made.map(|_| ()).map_err(|refused| refused.1)
}
