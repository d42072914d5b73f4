//! Cost of a takeover on the thread of the cycle, which must not depend on the size of the commands.

use crate::{MS, with_temp_dir};
use rpi_bench::table::Table;
use rpi_bench::{FakeDevices, NetBuilder, image_compare, net_builder};
use rpi_core::{AbortReason, Command, CommandId, Core, Rule};
use rpi_image::{Image, Scalar, Value};
use rpi_lower::LowerOptions;
use rpi_net::{FragmentId, Input, Net, ResultKind};
use std::path::Path;
use std::process::Command as Process;
use std::sync::Arc;

/// First argument with which this benchmark starts itself as a process that runs takeovers under callgrind.
pub(crate) const CHILD: &str = "switch-child";

/// Number of commands that the measured core can hold; it equals the default of a control core.
const CAPACITY: usize = 64;
/// Number of axes that the successor takes over from its predecessor.
const AXES: i64 = 7;
/// Number of ticks of a round; the takeover, if there is one, is in the middle.
const TICKS: u64 = 8;
/// Pattern of the name of the function whose processor instructions callgrind counts, including the functions that it
/// calls.
const COUNTED: &str = "*counted_tick*";
/// Key of the input of a command with the number of cycles after which the command ends.
const LIMIT: &str = "limit";

/// Returns a command of about `size` primitives, half of them with state. The command moves seven axes and ends after
/// the number of cycles that its input gives.
fn net(size: usize) -> Net {
    let root = FragmentId::ROOT;
    let mut b = NetBuilder::new("Chain");
    let limit = [
        ("Key", Value::Str(LIMIT.into())),
        ("Value", Value::real(1e9)),
    ];
    let limit = b.add_with(root, "Core::DoubleNetcommIn", &[], &limit);
    let clock = b.add(root, "Core::Clock", &[]);
    let mut flow = clock;
    for _ in 0..size / 2 {
        let inputs = [Input::Port(flow), net_builder::real(0.9)];
        let half = b.add(root, "Core::DoubleMultiply", &inputs);
        if let Some(before) = b.total_delay(root, Scalar::Real) {
            b.wire(before.node, 0, half);
            flow = before;
        }
    }
    for axis in 0..AXES {
        let params = [
            ("Robot", Value::Str("arm".into())),
            ("Axis", Value::int(axis)),
        ];
        b.add_with(
            root,
            "RobotArm::JointPosition",
            &[Input::Port(flow)],
            &params,
        );
    }
    let cycles = [Input::Port(clock), net_builder::real(1000.0)];
    let cycles = b.add(root, "Core::DoubleMultiply", &cycles);
    let ends = [Input::Port(cycles), Input::Port(limit)];
    let ends = b.add(root, "Core::DoubleGreater", &ends);
    b.result("done", ResultKind::Finish, ends);
    b.net
}

/// Adds the number of processor instructions of a takeover to the table: the instructions of a round with a takeover,
/// minus those of a round without one.
pub(crate) fn rows(table: &mut Table) {
    for size in [10, 100, 1000, 10_000] {
        let row = format!("switch, commands of {size}");
        if !table.is_selected(&row) {
            continue;
        }
        let image = image_compare::lower_net(&net(size), &LowerOptions::running(MS))
            .expect("it can be lowered");
        match instructions(&image) {
            Some((switch, steady)) => {
                let note = format!("a steady tick takes {steady:.0}");
                table.add_row(&row, switch, 2000.0, "instructions", &note);
            }
            None => eprintln!("{row}: no valgrind, or no switch"),
        }
    }
}

/// Returns the number of processor instructions of a takeover, and of a tick without one; `None` if valgrind is not
/// available.
fn instructions(image: &Image) -> Option<(f64, f64)> {
    let count = |rounds: u64, switches: bool| {
        with_temp_dir(|dir| {
            let path = dir.join("net.rpib");
            std::fs::write(&path, image.to_bytes()).map_err(|e| e.to_string())?;
            callgrind(&path, rounds, switches).ok_or_else(String::new)
        })
    };
    let per_round = |switches| Some((count(30, switches)? - count(10, switches)?) / 20.0);
    let (with, without) = (per_round(true)?, per_round(false)?);
    Some((with - without, without / TICKS as f64))
}

fn callgrind(path: &Path, rounds: u64, switches: bool) -> Option<f64> {
    let output = Process::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(format!("--toggle-collect={COUNTED}"))
        .arg(std::env::current_exe().ok()?)
        .arg(CHILD)
        .arg(path)
        .arg(rounds.to_string())
        .arg(switches.to_string())
        .output()
        .ok()
        .filter(|output| output.status.success())?;
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    let line = text.lines().find(|l| l.contains("Collected"))?;
    line.split_whitespace().last()?.parse().ok()
}

/// Runs rounds of eight ticks with two commands. If `switches` is true, the second command takes over in the middle of
/// each round; else the first one runs to the end of the round.
pub(crate) fn run_rounds(path: &Path, rounds: u64, switches: bool) {
    let bytes = std::fs::read(path).unwrap_or_default();
    let image = Arc::new(Image::from_bytes(&bytes).expect("it was written by us"));
    let (mut core, mut bank) = (Core::with_capacity(CAPACITY, MS), FakeDevices::new());
    for _ in 0..rounds {
        let limits = match switches {
            // The flow `time` of a command is one period in its first cycle.
            true => [(TICKS / 2) as f64 - 0.5, 1e9],
            false => [1e9, 1e9],
        };
        let [first, second] = limits.map(|limit| insert(&mut core, &image, limit, &mut bank));
        let rule = Rule::follow(first).start(second).keep_orphans();
        core.schedule(Box::new(rule), &mut bank)
            .expect("nothing is against it");
        core.start(first, &mut bank).expect("all is free");
        (0..TICKS).for_each(|_| counted_tick(&mut core, &mut bank));
        let ran = core.command(second).map_or(0, |c| c.instance().cycle());
        assert_eq!(ran, if switches { TICKS / 2 } else { 0 });
        clear(&mut core, [first, second], &mut bank);
    }
}

fn insert(core: &mut Core, image: &Arc<Image>, limit: f64, bank: &mut FakeDevices) -> CommandId {
    let mut command = Command::load(Arc::clone(image), bank).expect("it has every device");
    let input = image.inputs.iter().position(|i| i.key == LIMIT);
    command.set_input(input.expect("it has a limit"), &[limit.to_bits()]);
    let id = core.insert(Box::new(command)).map_err(|(_, why)| why);
    id.expect("there is room")
}

/// Removes the two commands and all pending notices from the core, so that the next round starts with an empty core.
fn clear(core: &mut Core, ids: [CommandId; 2], bank: &mut FakeDevices) {
    for id in ids {
        // A command that has ended or never ran cannot be aborted; the error is expected.
        let _ = core.abort(id, AbortReason::Request, bank);
        core.remove(id).map(drop).expect("it does not run");
    }
    while core.next_notice().is_some() || core.take_finished_rule().is_some() {}
}

/// Runs one tick of the core. The function is not inlined, so that callgrind can find it by its name.
#[inline(never)]
fn counted_tick(core: &mut Core, bank: &mut FakeDevices) {
    core.tick(bank, 0, &mut ());
}
