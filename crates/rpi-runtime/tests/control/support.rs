//! Test support: a control core with an empty cell, and commands that count.

use std::sync::Arc;

use rpi_bench::{NetBuilder, image_compare, net_builder};
use rpi_device::NoDevices;
use rpi_image::{Image, Value};
use rpi_lower::LowerOptions;
use rpi_net::{FragmentId, Input, ResultKind};
use rpi_runtime::control::{CommandId, Control, Event, Executive, Options, open};
use rpi_sim::{Cell, SimBank};

pub(crate) struct TestCore {
    pub(crate) control: Control,
    pub(crate) executive: Executive<SimBank>,
    pub(crate) options: Options,
}

impl TestCore {
    /// Creates a control core for this number of commands.
    pub(crate) fn new(commands: usize) -> TestCore {
        let options = Options {
            commands,
            requests: 64,
            ..Options::default()
        };
        let cell = Cell::parse("cell.toml", "").unwrap_or_else(|e| panic!("{e}"));
        let plant = SimBank::new(&cell, 1e-3);
        let (control, executive) = open(plant, Box::new(NoDevices), options);
        TestCore {
            control,
            executive,
            options,
        }
    }

    pub(crate) fn load(&mut self, image: Arc<Image>) -> CommandId {
        self.control.load(image).unwrap()
    }

    /// Executes ticks. Allocations on the cycle side are forbidden.
    pub(crate) fn ticks(&mut self, count: usize) {
        rpi_testkit::no_alloc(|| (0..count).for_each(|_| self.executive.tick(0, &mut ())));
    }

    /// Returns all events since the last call.
    pub(crate) fn log(&mut self) -> Vec<Event> {
        std::iter::from_fn(|| self.control.poll()).collect()
    }
}

/// Returns a command that adds its input `step` (default 1) to `count` in every cycle. It exports `count` and the
/// Boolean `late`, and ends with `done` once `count` reaches `most`.
pub(crate) fn counter(name: &str, most: u32) -> Arc<Image> {
    let root = FragmentId::ROOT;
    let mut b = NetBuilder::new(name);
    let key = |key: &str| ("Key", Value::Str(key.into()));
    let step = b.add_with(
        root,
        "Core::DoubleNetcommIn",
        &[],
        &[key("step"), ("Value", Value::real(1.0))],
    );
    let before = b.add(root, "Rpi::DoublePre", &[]);
    let count = b.add(
        root,
        "Core::DoubleAdd",
        &[Input::Port(step), Input::Port(before)],
    );
    b.wire(before.node, 0, count);
    b.export("count", count);
    let over = |b: &mut NetBuilder, limit: f64| {
        let inputs = [Input::Port(count), net_builder::real(limit)];
        b.add(root, "Core::DoubleGreater", &inputs)
    };
    let late = over(&mut b, f64::from(most) * 0.5);
    b.add_with(
        root,
        "Core::BooleanNetcommOut",
        &[Input::Port(late)],
        &[key("late")],
    );
    let done = over(&mut b, f64::from(most) - 0.5);
    b.result("done", ResultKind::Finish, done);
    let image = image_compare::lower_net(&b.net, &LowerOptions::running(1_000_000));
    Arc::new(image.unwrap_or_else(|e| panic!("{e}")))
}
