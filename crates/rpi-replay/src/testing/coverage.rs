//! Coverage of a net by a test: active fragments, branches and transitions.

use std::collections::BTreeMap;

use rpi_core::Instance;
use rpi_diag::Span;
use rpi_image::Image;
use rpi_image::image::Signal;
use rpi_net::{Decision, FragmentId, Input, Net, PortRef, StateTransitions};

/// Coverage of a test by location in the source: which fragments, branches and transitions of the net were used. Each
/// instance of a unit (node, command or function) has entries of its own.
#[derive(Clone, Debug)]
pub struct Coverage {
    /// Locations of the names, in their declarations, of all units (nodes, commands and functions) that the test calls.
    pub called: Vec<Span>,
    /// Each fragment (conditionally active part of the net) except the root: location, path, and whether it was ever
    /// active.
    pub fragments: Vec<(Span, String, bool)>,
    /// Each branching of an `if`: location, and whether its condition was ever false and ever true while the `if` was
    /// reachable.
    pub branches: Vec<(Span, [bool; 2])>,
    /// Each transition of an automaton: location in the source, and whether it was ever taken.
    pub transitions: Vec<(Span, bool)>,
    choices: Vec<Branch>,
    exits: Vec<AutomatonState>,
}

/// Boolean flow of a net, with the place of its value in the memory of the running image.
#[derive(Clone, Copy, Debug)]
enum ObservedBoolean {
    /// The Boolean is constant and has this value in every cycle.
    Constant(bool),
    /// The Boolean is computed in each cycle: its place and type in memory, and the index of its fragment.
    Computed(Signal, u32),
    /// The Boolean is absent in all cycles.
    Absent,
}

/// Branching of an `if`, for coverage. A cycle counts if the fragment of the `if` is active, and the enclosing `if`
/// takes the branch with it.
#[derive(Clone, Debug)]
struct Branch {
    condition: ObservedBoolean,
    /// Index of the fragment with the `if`; `None` if the fragment is never active.
    fragment: Option<u32>,
    /// Index of the enclosing `if`, which is smaller, and the value of its condition with which this `if` is reachable;
    /// `None` if no `if` encloses it.
    enclosing: Option<(usize, bool)>,
}

/// State of an automaton, for coverage, with the conditions of its outgoing transitions by descending priority.
#[derive(Clone, Debug)]
struct AutomatonState {
    is_current: ObservedBoolean,
    conditions: Vec<ObservedBoolean>,
}

impl Coverage {
    pub(super) fn new(net: &Net, image: &Image) -> Coverage {
        let places = ImageIndex::new(net, image);
        let marks = &net.coverage_points;
        let transitions = marks
            .state_transitions
            .iter()
            .flat_map(|exits| &exits.transitions);
        let choices = marks.decisions.iter();
        Coverage {
            called: marks.called_units.clone(),
            fragments: fragments(net, image),
            branches: choices.clone().map(|one| (one.span, [false; 2])).collect(),
            transitions: transitions.map(|exit| (exit.span, false)).collect(),
            choices: choices.map(|one| places.decision(one)).collect(),
            exits: marks
                .state_transitions
                .iter()
                .map(|one| places.state(one))
                .collect(),
        }
    }

    pub(super) fn update(&mut self, machine: &Instance) {
        for (k, fragment) in (1..).zip(&mut self.fragments) {
            fragment.2 |= machine.is_active(k);
        }
        self.update_branches(machine);
        let mut first = 0;
        for state in &self.exits {
            if let Some(k) = state.taken_transition(machine) {
                self.transitions[first + k].1 = true;
            }
            first += state.conditions.len();
        }
    }

    fn update_branches(&mut self, machine: &Instance) {
        let mut taken: Vec<Option<bool>> = Vec::with_capacity(self.choices.len());
        for (choice, (_, seen)) in self.choices.iter().zip(&mut self.branches) {
            let around = choice.enclosing;
            let matters = choice
                .fragment
                .is_some_and(|fragment| machine.is_active(fragment))
                && around.is_none_or(|(outer, side)| taken.get(outer) == Some(&Some(side)));
            let value = choice.condition.value(machine).filter(|_| matters);
            if let Some(value) = value {
                seen[usize::from(value)] = true;
            }
            taken.push(value);
        }
    }
}

impl ObservedBoolean {
    /// Returns the value of the Boolean in this cycle; `None` if it is absent.
    fn value(&self, machine: &Instance) -> Option<bool> {
        match *self {
            ObservedBoolean::Constant(value) => Some(value),
            ObservedBoolean::Computed(signal, fragment) if machine.is_active(fragment) => {
                machine.value(signal).map(|value| value[0] != 0)
            }
            ObservedBoolean::Computed(..) | ObservedBoolean::Absent => None,
        }
    }
}

impl AutomatonState {
    /// Returns the index of the state's transition that is taken in this cycle; `None` if the state is not active or no
    /// transition is taken.
    fn taken_transition(&self, machine: &Instance) -> Option<usize> {
        let holds = |watched: &ObservedBoolean| watched.value(machine) == Some(true);
        let mut conditions = self.conditions.iter();
        holds(&self.is_current).then(|| conditions.position(holds))?
    }
}

/// Index by name of the ports and fragments in the image of a net.
struct ImageIndex<'n> {
    net: &'n Net,
    ports: BTreeMap<String, (Signal, u32)>,
    fragments: BTreeMap<String, u32>,
}

impl<'n> ImageIndex<'n> {
    fn new(net: &'n Net, image: &Image) -> ImageIndex<'n> {
        let probes = image.debug.probes.iter();
        let ports = probes.map(|p| (image.probe_name(p), (p.value, p.fragment)));
        let fragments = (0..).zip(&image.fragments).skip(1);
        ImageIndex {
            net,
            ports: ports.collect(),
            fragments: fragments.map(|(k, of)| (of.path.clone(), k)).collect(),
        }
    }

    fn decision(&self, choice: &Decision) -> Branch {
        Branch {
            condition: self.input(&choice.condition),
            fragment: self.fragment(choice.fragment),
            enclosing: (choice.branch).map(|side| (side.decision as usize, side.outcome)),
        }
    }

    fn state(&self, exits: &StateTransitions) -> AutomatonState {
        let transitions = exits.transitions.iter();
        AutomatonState {
            is_current: self.input(&exits.is_active),
            conditions: transitions
                .map(|exit| self.input(&exit.condition))
                .collect(),
        }
    }

    fn fragment(&self, id: FragmentId) -> Option<u32> {
        match id {
            FragmentId::ROOT => Some(0),
            _ => self.fragments.get(&path_of(self.net, id)).copied(),
        }
    }

    fn port(&self, port: PortRef) -> ObservedBoolean {
        let node = self.net.node(port.node);
        let name = node.desc().outputs.get(usize::from(port.port));
        let path = self.net.path(node.fragment, &node.name);
        let place = name.and_then(|port| self.ports.get(&format!("{path}.{}", port.name)));
        place.map_or(ObservedBoolean::Absent, |&(signal, fragment)| {
            ObservedBoolean::Computed(signal, fragment)
        })
    }

    fn input(&self, input: &Input) -> ObservedBoolean {
        match input {
            Input::Port(port) => self.port(*port),
            Input::Const(value) => value
                .as_bool()
                .map_or(ObservedBoolean::Absent, ObservedBoolean::Constant),
            Input::Unconnected => ObservedBoolean::Absent,
        }
    }
}

/// Returns location and path of each fragment of an image except the root, marked as not covered yet.
fn fragments(net: &Net, image: &Image) -> Vec<(Span, String, bool)> {
    let ids = net.fragment_ids().skip(1);
    let places = ids.map(|id| (path_of(net, id), net.fragment(id).origin.span));
    let places: BTreeMap<String, Span> = places.collect();
    let inner = image.fragments.iter().skip(1);
    inner
        .map(|fragment| {
            let place = places.get(&fragment.path).copied().unwrap_or(Span::NONE);
            (place, fragment.path.clone(), false)
        })
        .collect()
}

fn path_of(net: &Net, id: FragmentId) -> String {
    let fragment = net.fragment(id);
    net.path(fragment.parent.unwrap_or(FragmentId::ROOT), &fragment.name)
}
