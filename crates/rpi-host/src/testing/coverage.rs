//! What a test has seen of a net: fragments that were active, choices that went either way, transitions that were taken.

use std::collections::{BTreeMap, BTreeSet};

use rpi_core::Machine;
use rpi_diag::Span;
use rpi_image::Image;
use rpi_image::image::Signal;
use rpi_net::{Exits, FragmentId, Input, Net, Node, PortRef};

/// What was seen so far, by places in the text; of what is instantiated several times there are as many entries.
#[derive(Clone, Debug)]
pub struct Coverage {
    /// Each fragment but the root: its place, its path, and whether it was ever active.
    pub fragments: Vec<(Span, String, bool)>,
    /// Each choice whose condition is not known before: whether it was ever false, and ever true.
    pub branches: Vec<(Span, [bool; 2])>,
    /// Each transition of an automaton, and whether it was ever taken.
    pub transitions: Vec<(Span, bool)>,
    conditions: Vec<Watched>,
    exits: Vec<State>,
}

/// A Boolean of the net while it runs.
#[derive(Clone, Copy, Debug)]
enum Watched {
    /// It is this in every cycle.
    Known(bool),
    /// It is computed in a fragment.
    Computed(Signal, u32),
    /// Nothing in any cycle.
    Absent,
}

/// A state of an automaton, and the conditions of the transitions that lead out of it, in order.
#[derive(Clone, Debug)]
struct State {
    here: Watched,
    conditions: Vec<Watched>,
}

impl Coverage {
    pub(super) fn new(net: &Net, image: &Image) -> Coverage {
        let probes = Probes::new(net, image);
        let (branches, conditions): (Vec<_>, Vec<_>) = choices(net)
            .into_iter()
            .map(|(span, port)| ((span, [false; 2]), probes.port(port)))
            .unzip();
        let state = |exits: &Exits| State {
            here: probes.input(&exits.here),
            conditions: (exits.transitions.iter())
                .map(|exit| probes.input(&exit.condition))
                .collect(),
        };
        let transitions = net.exits.iter().flat_map(|exits| &exits.transitions);
        Coverage {
            fragments: fragments(net, image),
            branches,
            transitions: transitions.map(|exit| (exit.span, false)).collect(),
            conditions,
            exits: net.exits.iter().map(state).collect(),
        }
    }

    pub(super) fn look(&mut self, machine: &Machine) {
        for (k, fragment) in (1..).zip(&mut self.fragments) {
            fragment.2 |= machine.is_active(k);
        }
        for ((_, seen), condition) in self.branches.iter_mut().zip(&self.conditions) {
            if let Some(value) = condition.value(machine) {
                seen[usize::from(value)] = true;
            }
        }
        let mut first = 0;
        for state in &self.exits {
            if let Some(k) = state.taken(machine) {
                self.transitions[first + k].1 = true;
            }
            first += state.conditions.len();
        }
    }
}

impl Watched {
    /// Its value in this cycle, if it has one.
    fn value(&self, machine: &Machine) -> Option<bool> {
        match *self {
            Watched::Known(value) => Some(value),
            Watched::Computed(signal, fragment) if machine.is_active(fragment) => {
                machine.value(signal).map(|value| value[0] != 0)
            }
            Watched::Computed(..) | Watched::Absent => None,
        }
    }
}

impl State {
    /// Which transition is taken in this cycle.
    fn taken(&self, machine: &Machine) -> Option<usize> {
        let holds = |watched: &Watched| watched.value(machine) == Some(true);
        let mut conditions = self.conditions.iter();
        holds(&self.here).then(|| conditions.position(holds))?
    }
}

/// Where the ports of a net are found in its image.
struct Probes<'n> {
    net: &'n Net,
    places: BTreeMap<String, (Signal, u32)>,
}

impl<'n> Probes<'n> {
    fn new(net: &'n Net, image: &Image) -> Probes<'n> {
        let probes = image.probes.iter();
        let places = probes.map(|p| (image.probe_name(p), (p.value, p.fragment)));
        Probes {
            net,
            places: places.collect(),
        }
    }

    fn port(&self, port: PortRef) -> Watched {
        let node = self.net.node(port.node);
        let name = node.desc().outputs.get(usize::from(port.port));
        let path = self.net.path(node.fragment, &node.name);
        let place = name.and_then(|port| self.places.get(&format!("{path}.{}", port.name)));
        place.map_or(Watched::Absent, |&(signal, fragment)| {
            Watched::Computed(signal, fragment)
        })
    }

    fn input(&self, input: &Input) -> Watched {
        match input {
            Input::Port(port) => self.port(*port),
            Input::Const(value) => value.as_bool().map_or(Watched::Absent, Watched::Known),
            Input::Open => Watched::Absent,
        }
    }
}

/// The choices of a net, each once: a choice between composite values is one primitive per leaf. What an automaton chooses
/// is told as its transitions.
fn choices(net: &Net) -> BTreeSet<(Span, PortRef)> {
    let automata: BTreeSet<Span> = net.exits.iter().map(|exits| exits.automaton).collect();
    let is_choice = |node: &&Node| {
        let span = node.origin.span;
        node.desc().name.ends_with("Conditional") && !span.is_none() && !automata.contains(&span)
    };
    let conditionals = net.nodes.iter().filter(is_choice);
    conditionals
        .filter_map(|node| match node.inputs.first()? {
            Input::Port(port) => Some((node.origin.span, *port)),
            _ => None,
        })
        .collect()
}

/// Where the fragments of an image stand in the text.
fn fragments(net: &Net, image: &Image) -> Vec<(Span, String, bool)> {
    let places: BTreeMap<String, Span> = net
        .fragment_ids()
        .skip(1)
        .map(|id| {
            let fragment = net.fragment(id);
            let parent = fragment.parent.unwrap_or(FragmentId::ROOT);
            (net.path(parent, &fragment.name), fragment.origin.span)
        })
        .collect();
    let inner = image.fragments.iter().skip(1);
    inner
        .map(|fragment| {
            let place = places.get(&fragment.path).copied().unwrap_or(Span::NONE);
            (place, fragment.path.clone(), false)
        })
        .collect()
}
