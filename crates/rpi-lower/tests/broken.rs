//! Damaged images: the reader and the verifier report the damage, and every image that the verifier accepts runs.

use rpi_bench::rng::Rng;
use rpi_bench::{FakeDevices, NetBuilder, generate, image_compare, net_builder};
use rpi_core::{CycleContext, Instance, prim_desc};
use rpi_image::image::{CommandEnd, Signal};
use rpi_image::{Form, Image, ReadError, Step, Value, verify};
use rpi_lower::LowerOptions;
use rpi_net::{FragmentId, Input, Net, Restart};

const MS: u64 = 1_000_000;

/// A net with every kind of step and table: fragments, restarts, delays, arrays, sized state, a device.
fn varied() -> Net {
    let root = FragmentId::ROOT;
    let mut b = NetBuilder::new("varied");
    let key = ("Key", Value::Str("x".into()));
    let x = b.add_with(root, "Core::DoubleNetcommIn", &[], &[key]);
    let go = b.add(
        root,
        "Core::DoubleGreater",
        &[Input::Port(x), net_builder::real(0.2)],
    );
    let f = b.fragment(root, "f", go, Restart::OnActivation);
    let clock = b.add(f, "Core::Clock", &[]);
    let duration = ("Duration", Value::real(0.004));
    let mean = b.add_with(f, "Core::DoubleAverage", &[Input::Port(clock)], &[duration]);
    let late = b.add(f, "Core::DoublePre", &[Input::Port(mean)]);
    b.add(
        root,
        "Core::DoubleSetNull",
        &[Input::Port(x), Input::Port(go)],
    );
    let size = ("Size", Value::int(3));
    let list = b.add_with(root, "Core::DoubleArray", &[], &[size]);
    let list = b.add(
        root,
        "Core::DoubleArraySet",
        &[Input::Port(list), Input::Port(x)],
    );
    let got = b.add(root, "Core::DoubleArrayGet", &[Input::Port(list)]);
    let robot = ("Robot", Value::Str("arm".into()));
    let sensor = b.add_with(
        root,
        "RobotArm::JointMonitor",
        &[],
        std::slice::from_ref(&robot),
    );
    let sum = b.add(
        root,
        "Core::DoubleAdd",
        &[Input::Port(got), Input::Port(sensor)],
    );
    b.add_with(
        root,
        "RobotArm::JointPosition",
        &[Input::Port(sum)],
        &[robot],
    );
    b.export("late", late);
    b.export("sum", sum);
    b.terminate(go);
    b.net
}

fn images() -> Vec<Image> {
    let nets = [varied(), generate::mixed(150, 3), generate::pid(2)];
    let forms = [LowerOptions::running(MS), LowerOptions::observed(MS)];
    let pairs = nets
        .iter()
        .flat_map(|net| forms.iter().map(move |form| (net, form)));
    pairs
        .map(|(net, form)| image_compare::lower_net(net, form).expect("it can be lowered"))
        .collect()
}

#[test]
fn an_image_reads_as_it_was_written() {
    for image in images() {
        assert_eq!(verify(&image, &prim_desc), Ok(()));
        assert_eq!(Image::from_bytes(&image.to_bytes()), Ok(image));
    }
}

#[test]
fn a_damaged_file_is_refused() {
    let image =
        image_compare::lower_net(&varied(), &LowerOptions::running(MS)).expect("it can be lowered");
    let bytes = image.to_bytes();
    assert_eq!(
        Image::from_bytes(b"not an image"),
        Err(ReadError::NotAnImage)
    );
    for end in 0..bytes.len() {
        assert!(Image::from_bytes(&bytes[..end]).is_err(), "cut at {end}");
    }
    for at in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << (at % 8);
        assert!(Image::from_bytes(&damaged).is_err(), "byte {at}");
    }
}

/// Forged content with a valid checksum may be read as any image, but must never cause a panic.
#[test]
fn a_forged_file_does_no_harm() {
    let mut rng = Rng::new(5);
    for image in images() {
        let bytes = image.to_bytes();
        for _ in 0..300 {
            let mut forged = bytes.clone();
            let at = 14 + rng.below(forged.len() - 14);
            forged[at] = rng.next_bits().to_le_bytes()[0];
            let sum = rpi_image::hash::Fnv1a::new()
                .with_bytes(&forged[14..])
                .finish();
            forged[6..14].copy_from_slice(&sum.to_le_bytes());
            if let Ok(image) = Image::from_bytes(&forged) {
                run_if_verified(image);
            }
        }
    }
}

#[test]
fn a_changed_image_is_refused_or_runs() {
    let mut rng = Rng::new(7);
    let mut refused = 0;
    for image in images() {
        for _ in 0..600 {
            let mut changed = image.clone();
            change(&mut changed, &mut rng);
            refused += u32::from(!run_if_verified(changed));
        }
    }
    assert!(refused > 1000, "{refused}");
}

/// Runs an image if the verifier accepts it. Returns whether it did.
fn run_if_verified(image: Image) -> bool {
    if image.layout.end > 1 << 20 || verify(&image, &prim_desc).is_err() {
        return false;
    }
    let mut bank = FakeDevices::new();
    let Ok(mut machine) = Instance::load(image, &mut bank) else {
        return true;
    };
    for _ in 0..5 {
        machine.read(&mut bank, &CycleContext::default());
        machine.evaluate(&mut bank);
        machine.commit();
        machine.hand_over(&mut bank);
        let _ = machine.verdict(&[]);
    }
    true
}

/// Changes one number at a random place.
fn change(image: &mut Image, rng: &mut Rng) {
    let cells = image.layout.end as usize;
    let number = match rng.below(8) {
        0 => u32::MAX,
        1 => 0,
        _ => rng.below(cells + 3) as u32,
    };
    match rng.below(12) {
        0..4 if !image.code.is_empty() => {
            let at = rng.below(image.code.len());
            image.code[at] = number;
        }
        4..7 if !image.steps.is_empty() => {
            let at = rng.below(image.steps.len());
            change_step(&mut image.steps[at], number);
        }
        7 if !image.commit.is_empty() => {
            let at = rng.below(image.commit.len());
            change_step(&mut image.commit[at], number);
        }
        8 => image.layout.external = number,
        9 => image.layout.state = number,
        10 => image
            .exports
            .iter_mut()
            .for_each(|e| change_signal(&mut e.value, number)),
        _ => match &mut image.end {
            CommandEnd::Ports { terminate, .. } => {
                terminate.iter_mut().for_each(|s| change_signal(s, number));
            }
            CommandEnd::Results(_) => image.layout.end = number,
        },
    }
}

fn change_signal(signal: &mut Signal, number: u32) {
    match number % 2 {
        0 => signal.start = number,
        _ => signal.present = number,
    }
}

fn change_step(step: &mut Step, number: u32) {
    match step {
        Step::Run {
            form,
            start: at,
            len,
            ..
        } => match number % 3 {
            0 => *at = number,
            1 => *len = number,
            _ => {
                *form = if *form == Form::Total {
                    Form::Optional
                } else {
                    Form::Total
                }
            }
        },
        Step::Copy { at, len } => match number % 2 {
            0 => *at = number,
            _ => *len = number,
        },
        Step::Skip { unless, target: to } => match number % 2 {
            0 => *unless = number,
            _ => *to = number,
        },
        Step::Reset { unless, fragment } => match number % 2 {
            0 => *unless = number,
            _ => *fragment = number,
        },
        Step::Actuate { actuator } => *actuator = number,
        Step::Call { function } => *function = number,
    }
}
