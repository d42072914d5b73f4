[
  (body) (steps) (automaton) (state) (device_section) (ports) (arguments) (static_arguments) (enum) (struct)
] @indent.begin
["tel" "end" ")" ">>" "}"] @indent.branch
["tel" "end" ")" ">>" "}"] @indent.end
