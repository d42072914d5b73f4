//! Devices: those of the cell, and simulated ones that clients add and remove while commands run.

use std::collections::BTreeMap;
use std::sync::PoisonError;

use rpi_image::Scalar;
use rpi_kin::AxisLimits;
use rpi_runtime::control::State;
use rpi_sim::cell::{ArmSpec, DeviceSpec, Enforced, Kind};
use rpi_sim::{Cell, Part};

use super::owed::Debt;
use super::{Desk, DeviceInfo, Failure, Phase, Reply, Sink, Then, Update};
use crate::fair::Taken;
use crate::peer::Peer;

/// The devices by slot, and the subscribers to changes.
pub(super) struct Devices {
    places: Vec<Option<DeviceInfo>>,
    /// Peer of the client that added the device in each slot. A device outlives the connection of its client.
    makers: Vec<Option<Peer>>,
    pub(super) watchers: Vec<Box<dyn Sink>>,
    seed: u64,
    /// Number of devices of the cell, which come first. Clients cannot remove them.
    own: usize,
}

impl Devices {
    pub(super) fn of(cell: &Cell, most: usize) -> Devices {
        let infos = cell
            .devices
            .iter()
            .map(|spec| Some(info(spec, kind_name(&spec.kind))));
        let mut places: Vec<Option<DeviceInfo>> = infos.collect();
        places.resize(most.max(places.len()), None);
        Devices {
            makers: vec![None; places.len()],
            places,
            watchers: Vec::new(),
            seed: cell.seed,
            own: cell.devices.len(),
        }
    }

    /// Returns whether any device moves.
    pub(super) fn move_still(&self) -> bool {
        self.places.iter().flatten().any(|info| info.moving)
    }

    /// Returns the name of the device of an actuator. The upper 16 bits of `resource` are the device slot.
    pub(super) fn name(&self, resource: u32) -> String {
        let info = self.places.get((resource >> 16) as usize);
        let info = info.and_then(Option::as_ref);
        info.map_or_else(|| "a device".to_owned(), |info| info.name.clone())
    }

    /// Returns the display name of an actuator: device and index.
    pub(super) fn actuator(&self, resource: u32) -> String {
        format!("{}[{}]", self.name(resource), resource & 0xffff)
    }

    /// Returns a free slot for a device of this peer, or an error if its share is used up.
    fn place_for(&self, peer: Peer) -> Result<usize, Failure> {
        let made = self.places.iter().zip(&self.makers).skip(self.own);
        let made = made.filter(|(device, _)| device.is_some());
        let own = made.clone().filter(|(_, maker)| **maker == Some(peer));
        let taken = Taken::by_peer(made.count(), own.count());
        let room = taken.admit(1, self.places.len() - self.own);
        room.map_err(|full| Failure::limit(full, DEVICES))?;
        let free = self.places.iter().position(Option::is_none);
        free.ok_or(Failure::Limit(DEVICES))
    }

    fn find(&self, name: &str) -> Option<usize> {
        let is = |info: &Option<DeviceInfo>| info.as_ref().is_some_and(|i| i.name == name);
        self.places.iter().position(is)
    }
}

/// Name of the device limit in messages.
const DEVICES: &str = "devices";

/// Characters that are not allowed in a device name, because protocols and pages use them as delimiters.
const SET_OFF: &[char] = &['"', '\\', '<', '>'];

/// Parameters of a simulated device that are used. Clients of the reference system send further ones.
pub(crate) const PARAMETERS: [&str; 5] = [
    "link_lengths",
    "min_joint",
    "max_joint",
    "max_vel",
    "max_acc",
];

/// A request to add a device.
#[derive(Debug)]
pub(crate) struct NewDevice<'a> {
    /// Peer of the client.
    pub(crate) peer: Peer,
    pub(crate) name: &'a str,
    pub(crate) kind: &'a str,
    pub(crate) parameters: &'a BTreeMap<String, String>,
}

impl Desk {
    /// Returns all devices.
    pub(crate) fn devices(&self) -> impl Iterator<Item = &DeviceInfo> {
        self.devices.places.iter().flatten()
    }

    /// Subscribes to devices: reports all of them now, and changes later.
    pub(crate) fn watch_devices(&mut self, mut sink: Box<dyn Sink>) {
        let mut there = self.devices.places.iter().flatten();
        if there.all(|info| sink.tell(&Update::DeviceAdded(info))) {
            self.devices.watchers.push(sink);
        }
    }

    pub(super) fn generation(&self) -> u64 {
        let twin = self.twin.lock().unwrap_or_else(PoisonError::into_inner);
        twin.generation
    }

    /// Adds a simulated device. A device of the same name and type is kept as it is.
    pub(crate) fn add_device(&mut self, new: &NewDevice<'_>, reply: Reply) {
        if let Some(place) = self.devices.find(new.name) {
            let same = self.devices.places[place]
                .as_ref()
                .is_some_and(|i| i.kind == new.kind);
            return reply(match same {
                true => Ok(new.name.to_owned()),
                false => Err(Failure::Bad(format!(
                    "a device {} of another type exists already",
                    new.name
                ))),
            });
        }
        if let Err(why) = self.may_be_named(new.name) {
            return reply(Err(why));
        }
        let spec = self
            .may_ask()
            .and_then(|()| spec(new, self.tick_ns as f64 * 1e-9));
        match spec.and_then(|spec| Ok((self.devices.place_for(new.peer)?, spec))) {
            Ok((place, spec)) => {
                self.devices.makers[place] = Some(new.peer);
                self.put(place, &spec, new.kind, reply);
            }
            Err(why) => reply(Err(why)),
        }
    }

    /// Returns an error if the name is not allowed. It is shown unescaped in pages, messages and the log.
    fn may_be_named(&self, name: &str) -> Result<(), Failure> {
        if name.len() > self.limits.name {
            return Err(Failure::Limit("bytes of a name"));
        }
        let is_bad = |c: char| c.is_control() || SET_OFF.contains(&c);
        match name.trim().is_empty() || name.contains(is_bad) {
            true => Err(Failure::Bad(format!(
                "{name:?} is not a device name: it must not be blank or contain line breaks, quotes, `\\`, `<` or `>`"
            ))),
            false => Ok(()),
        }
    }

    fn put(&mut self, place: usize, spec: &DeviceSpec, kind: &str, reply: Reply) {
        let tick = self.tick_ns as f64 * 1e-9;
        let part = || Part::new(spec, tick, self.devices.seed, place);
        // Two equal parts: one for the cycle, one for resolving names outside of it.
        let (own, twins) = (part(), part());
        self.change_twin(place, Some(twins));
        let info = info(spec, kind);
        self.devices.places[place] = Some(info.clone());
        let ticket = self.control.put_device(place, Some(own));
        if !self.asked(ticket, Then::Device(info), Some(reply)) {
            self.unchanged(place);
        }
    }

    /// Undoes a change that could not be sent to the cycle.
    fn unchanged(&mut self, place: usize) {
        self.change_twin(place, None);
        self.devices.places[place] = None;
    }

    fn change_twin(&mut self, place: usize, part: Option<Part>) {
        let mut twin = self.twin.lock().unwrap_or_else(PoisonError::into_inner);
        twin.bank.swap(place, part);
        twin.generation += 1;
    }

    /// Removes a device that was added by a client and is not in use. Ended commands that used it are unloaded first.
    pub(crate) fn remove_device(&mut self, name: &str, reply: Reply) {
        // Processes events first, so that commands unloaded a moment ago do not count as users.
        self.keep();
        let found = self.may_ask().and_then(|()| self.removable(name));
        let (place, ended) = match found {
            Ok(found) => found,
            Err(why) => return reply(Err(why)),
        };
        self.change_twin(place, None);
        self.devices.places[place] = None;
        for number in ended {
            if let Some(record) = self.commands.get(&number) {
                let called = record.called(number);
                self.journal.note(format_args!(
                    "{called} is unloaded because device {name} is removed"
                ));
            }
            self.owe(number, Debt::Unload);
        }
        let then = Then::NoDevice(name.to_owned());
        let ticket = self.control.put_device(place, None);
        self.asked(ticket, then, Some(reply));
    }

    /// Returns the slot of a removable device and the ended commands that used it.
    fn removable(&self, name: &str) -> Result<(usize, Vec<u64>), Failure> {
        let unknown = || Failure::Unknown(format!("device {name}"));
        let place = self.devices.find(name).ok_or_else(unknown)?;
        if place < self.devices.own {
            return Err(Failure::InUse(format!("device {name} belongs to the cell")));
        }
        let users = self.commands.iter().filter(|(_, r)| r.uses(name));
        let (ended, holding): (Vec<_>, Vec<_>) =
            users.partition(|(_, r)| r.status.phase == Phase::Is(State::Terminated));
        match holding.first() {
            Some((number, record)) => Err(Failure::InUse(format!(
                "device {name} is held by n{number} ({}): unload it first",
                record.title
            ))),
            None => Ok((
                place,
                ended.into_iter().map(|(number, _)| *number).collect(),
            )),
        }
    }

    pub(super) fn device_there(&mut self, info: DeviceInfo) -> String {
        self.tell_of_devices(&Update::DeviceAdded(&info));
        let name = &info.name;
        self.journal.note(format_args!("device {name} was added"));
        info.name
    }

    /// Called when the error code of the device in a slot changes, or when the device starts or stops moving.
    pub(super) fn device_changed(&mut self, place: usize, code: i64, moving: bool) {
        let places = &mut self.devices.places;
        let Some(Some(info)) = places.get_mut(place) else {
            return;
        };
        info.moving = moving;
        if std::mem::replace(&mut info.code, code) != code {
            let name = info.name.clone();
            self.tell_of_devices(&Update::DeviceCondition(&name, code));
            let how = rpi_sim::code::Code(code);
            self.journal.note(format_args!("device {name}: {how}"));
        }
    }

    fn tell_of_devices(&mut self, update: &Update<'_>) {
        self.devices.watchers.retain_mut(|sink| sink.tell(update));
    }

    pub(super) fn device_gone(&mut self, name: &str) {
        self.tell_of_devices(&Update::DeviceRemoved(name));
        self.journal.note(format_args!("device {name} was removed"));
    }
}

impl super::Record {
    /// Returns whether the command uses the device as a sensor, an actuator or in a function.
    fn uses(&self, device: &str) -> bool {
        self.image.as_ref().is_some_and(|image| {
            let sensors = image.sensors.iter().map(|s| &s.port);
            let actuators = image.actuators.iter().map(|a| &a.port);
            let functions = image.functions.iter().map(|f| &f.port);
            let mut ports = sensors.chain(actuators).chain(functions);
            ports.any(|port| port.device == device)
        })
    }
}

fn kind_name(kind: &Kind) -> &'static str {
    match kind {
        Kind::Arm(_) => "arm",
        Kind::Io(_) => "io",
        Kind::Base(_) => "base",
        Kind::Gripper(_) => "gripper",
        Kind::Force(_) => "force-torque",
    }
}

/// Returns the description of a device, with the interface names of the DirectIO protocol.
fn info(spec: &DeviceSpec, kind: &str) -> DeviceInfo {
    let plain = |name| (name, Vec::new());
    let interfaces = match &spec.kind {
        Kind::Arm(arm) => {
            let joints = arm.model.axes().to_string();
            vec![
                ("robotarm", vec![("jointcount".to_owned(), joints)]),
                plain("armkinematics"),
                plain("cartesianposition"),
            ]
        }
        Kind::Io(_) => vec![plain("io")],
        Kind::Base(_) => vec![plain("robotbase"), plain("cartesianposition")],
        Kind::Gripper(_) | Kind::Force(_) => Vec::new(),
    };
    DeviceInfo {
        name: spec.name.clone(),
        kind: kind.to_owned(),
        code: 0,
        moving: false,
        interfaces,
    }
}

/// Device types that clients may add, with the arm models that they can stand for.
pub(crate) const KINDS: &[(&str, &[&str])] = &[
    ("kuka_lwr_sim", &["kuka-lwr4+"]),
    ("kuka_iiwa_sim", &["kuka-iiwa-7", "kuka-iiwa-14"]),
];

fn spec(new: &NewDevice<'_>, tick: f64) -> Result<DeviceSpec, Failure> {
    let known = KINDS.iter().find(|(kind, _)| *kind == new.kind);
    let unknown = || {
        let known: Vec<&str> = KINDS.iter().map(|(kind, _)| *kind).collect();
        let known = known.join(", ");
        Failure::Unknown(format!("device type {}; known types: {known}", new.kind))
    };
    let (_, models) = known.ok_or_else(unknown)?;
    let models = models.iter().filter_map(|id| rpi_kin::models::by_id(id));
    let lengths = reals(new, "link_lengths")?.unwrap_or_default();
    let reach: f64 = lengths.iter().sum();
    let farness = |model: &&rpi_kin::ArmModel| (stretched(model) - reach).abs();
    let model = models.min_by(|a, b| farness(a).total_cmp(&farness(b)));
    let model = model.ok_or_else(unknown)?;
    let limits = limits(new, model.limits, tick)?;
    Ok(DeviceSpec {
        name: new.name.to_owned(),
        kind: Kind::Arm(ArmSpec {
            model,
            joints: limits
                .iter()
                .map(|l| 0.0_f64.clamp(l.position.lower, l.position.upper))
                .collect(),
            base: Default::default(),
            tool: Default::default(),
            surface: None,
            limits,
            enforced: Enforced {
                // As in the reference system's simulation: its clients plan paths without regard to joint velocities.
                position: true,
                velocity: false,
                acceleration: false,
                jerk: false,
            },
            lag: 0.0,
            latency: 0.0,
            noise: 0.0,
            faults: Vec::new(),
        }),
    })
}

/// Returns the distance of the flange from the base of the stretched arm in m.
fn stretched(model: &rpi_kin::ArmModel) -> f64 {
    let zero = vec![0.0; model.axes()];
    model.forward(&zero).translation.vector.norm()
}

/// Returns the limits of the model, overridden by those of the client. The client's motions end with full deceleration.
/// An arm with a low jerk limit would swing back after the last set-point, so the limit allows full acceleration within
/// one tick.
fn limits(new: &NewDevice<'_>, own: &[AxisLimits], tick: f64) -> Result<Vec<AxisLimits>, Failure> {
    let mut limits = own.to_vec();
    let mut set = |key: &str, place: fn(&mut AxisLimits) -> &mut f64| {
        let given = reals(new, key)?.unwrap_or_default();
        let axes = limits.iter_mut().zip(given);
        axes.filter(|(_, value)| value.is_finite())
            .for_each(|(axis, value)| *place(axis) = value);
        Ok::<(), Failure>(())
    };
    set("min_joint", |axis| &mut axis.position.lower)?;
    set("max_joint", |axis| &mut axis.position.upper)?;
    set("max_vel", |axis| &mut axis.velocity)?;
    set("max_acc", |axis| &mut axis.acceleration)?;
    for axis in &mut limits {
        axis.jerk = axis.jerk.max(axis.acceleration / tick);
    }
    let sound = |l: &AxisLimits| {
        l.position.lower < l.position.upper && l.velocity > 0.0 && l.acceleration > 0.0
    };
    match limits.iter().all(sound) {
        true => Ok(limits),
        false => Err(Failure::Bad(
            "limits must be positive and their ranges not empty".to_owned(),
        )),
    }
}

fn reals(new: &NewDevice<'_>, key: &str) -> Result<Option<Vec<f64>>, Failure> {
    let Some(text) = new.parameters.get(key) else {
        return Ok(None);
    };
    let bad = || Failure::Bad(format!("{key} must be a list of reals"));
    let values = rpi_literal::read_array(text, Scalar::Real).map_err(|_| bad())?;
    let values: Option<Vec<_>> = values.ok_or_else(bad)?.into_iter().collect();
    let reals = values
        .ok_or_else(bad)?
        .iter()
        .map(rpi_image::Value::as_real)
        .collect();
    Ok(reals)
}
