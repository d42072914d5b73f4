(node) @local.scope
(fragment) @local.scope
(local_fragment) @local.scope
(command) @local.scope
(task) @local.scope
(test) @local.scope
(state) @local.scope

(variables name: (identifier) @local.definition.var)
(constant name: (identifier) @local.definition.constant)
(target name: (identifier) @local.definition.var)
(local_fragment name: (identifier) @local.definition.namespace)
(identifier) @local.reference
