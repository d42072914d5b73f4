[
  (node) (fragment) (local_fragment) (command) (task) (test) (device) (state) (automaton) (steps) (enum) (struct)
] @fold
