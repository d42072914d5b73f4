//! Lowering of fragments: scopes that are skipped as a whole, and their restarts.

use super::Builder;
use crate::flat_net::{ScopeId, index};
use crate::registers::{Region, Register};
use rpi_image::image::{self, SlotRange};
use rpi_net::{AbsentPolicy, Activation, FragmentId, Net, PortRef, Restart};

/// Scope and activation register of each fragment that has been built so far.
pub(super) struct FragmentScopes {
    /// The scope in which each fragment runs.
    scopes: Vec<ScopeId>,
    /// For each fragment, the register that is true if the fragment is active whenever its parent is.
    active: Vec<Register>,
    /// Number of entries into each fragment so far.
    entry_counts: Vec<u32>,
}

impl FragmentScopes {
    pub(super) fn new(fragments: usize) -> Self {
        FragmentScopes {
            scopes: vec![ScopeId::ROOT; fragments],
            active: vec![Register::TRUE; fragments],
            entry_counts: vec![0; fragments],
        }
    }

    pub(super) fn scope(&self, fragment: FragmentId) -> ScopeId {
        self.scopes[fragment.index()]
    }

    /// The register that is true if a fragment is active whenever its parent is.
    pub(super) fn active(&self, fragment: FragmentId) -> Register {
        self.active[fragment.index()]
    }

    fn was_entered(&self, fragment: FragmentId) -> bool {
        self.entry_counts[fragment.index()] > 0
    }

    /// Counts an entry into a fragment. Returns the number of entries before it.
    pub(super) fn count_entry(&mut self, fragment: FragmentId) -> usize {
        let count = &mut self.entry_counts[fragment.index()];
        *count += 1;
        *count as usize - 1
    }
}

/// One table entry per fragment of the net. The activation is filled in when the fragment is built.
pub(super) fn fragment_table(net: &Net) -> Vec<image::Fragment> {
    let entry = |id: FragmentId| {
        let fragment = net.fragment(id);
        let parent = fragment.parent;
        image::Fragment {
            path: parent.map_or(String::new(), |p| net.path(p, &fragment.name)),
            parent: parent.map(|p| p.0),
            active: Register::TRUE.0,
            state: SlotRange::default(),
        }
    };
    net.fragment_ids().map(entry).collect()
}

impl Builder<'_> {
    pub(super) fn fragment(&mut self, id: FragmentId) {
        let net = self.net;
        let fragment = net.fragment(id);
        let Some(parent) = fragment.parent else {
            return;
        };
        let is_again = self.fragments.was_entered(id);
        let active = match is_again {
            true => self.fragments.active(id),
            false => self.activity(id, parent),
        };
        self.fragments.active[id.index()] = active;
        self.flat.tables.fragments[id.index()].active = active.0;
        if active == Register::TRUE && fragment.restart == Restart::Never {
            self.fragments.scopes[id.index()] = self.fragments.scope(parent);
            return self.items(id);
        }
        let scope = self.flat.open(self.fragments.scope(parent), active);
        self.fragments.scopes[id.index()] = scope;
        // The schedule may enter a fragment several times in a cycle; only the first entry may reset it.
        if !is_again {
            self.restart(id, parent, scope);
        }
        self.items(id);
        self.flat.close(scope);
    }

    /// The Boolean that activates a fragment, computed in the scope of its parent.
    fn activity(&mut self, id: FragmentId, parent: FragmentId) -> Register {
        let net = self.net;
        let Activation::When {
            condition,
            if_absent: absent,
        } = net.fragment(id).activation
        else {
            return Register::TRUE;
        };
        let flow = self.seen_from(condition, parent).flow;
        let scope = self.fragments.scope(parent);
        match absent {
            AbsentPolicy::Inactive => {
                self.logic
                    .and(&mut self.flat, scope, flow.value, flow.present)
            }
            AbsentPolicy::Active => {
                let missing = self.logic.not(&mut self.flat, scope, flow.present);
                self.logic.or(&mut self.flat, scope, flow.value, missing)
            }
        }
    }

    fn restart(&mut self, id: FragmentId, parent: FragmentId, scope: ScopeId) {
        let unless = match self.net.fragment(id).restart {
            Restart::Never => return,
            Restart::OnActivation => self.was_active(id, parent),
            Restart::Every(condition) => self.restart_not_requested(condition, parent, scope),
        };
        self.flat.scopes[scope.index()].reset = Some((unless, index(id.index())));
    }

    /// True if the fragment was active when its parent last was. It is part of the parent's state, so that a pause of
    /// the parent does not end the activation of the child.
    fn was_active(&mut self, id: FragmentId, parent: FragmentId) -> Register {
        let was = self.flat.registers.add(Region::State(parent), 1);
        let active = self.fragments.active(id);
        let outer = self.fragments.scope(parent);
        self.flat.scopes[outer.index()].latches.push((active, was));
        was
    }

    /// Negated restart condition; an absent condition counts as false.
    fn restart_not_requested(
        &mut self,
        condition: PortRef,
        parent: FragmentId,
        scope: ScopeId,
    ) -> Register {
        let flow = self.seen_from(condition, parent).flow;
        let outer = self.flat.scopes[scope.index()]
            .parent
            .unwrap_or(ScopeId::ROOT);
        let requested = self
            .logic
            .and(&mut self.flat, outer, flow.value, flow.present);
        self.logic.not(&mut self.flat, outer, requested)
    }

    /// Adds the copies that store the inputs of all delays for the next cycle.
    pub(super) fn latches(&mut self) {
        for (id, kept) in std::mem::take(&mut self.delays) {
            let link = self.link(id, 0);
            let scope = self.scope_of(id);
            let latches = &mut self.flat.scopes[scope.index()].latches;
            latches.push((link.flow.value, kept.value));
            if kept.present != Register::TRUE {
                latches.push((link.flow.present, kept.present));
            }
        }
    }
}
