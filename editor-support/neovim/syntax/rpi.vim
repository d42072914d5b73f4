" Made by `cargo xtask gen`; changes belong into the tables it is made from.
if exists("b:current_syntax")
  finish
endif

syntax keyword rpiKeyword and
syntax keyword rpiKeyword assert
syntax keyword rpiType bool
syntax keyword rpiKeyword const
syntax match rpiKeyword /\.\@1<!\<current\>\(\s*[=:,)]\)\@!/
syntax keyword rpiKeyword div
syntax keyword rpiKeyword else
syntax keyword rpiKeyword enum
syntax keyword rpiKeyword extern
syntax keyword rpiBoolean false
syntax keyword rpiKeyword fby
syntax keyword rpiKeyword function
syntax keyword rpiKeyword if
syntax keyword rpiType int
syntax keyword rpiKeyword let
syntax keyword rpiKeyword merge
syntax keyword rpiKeyword mod
syntax keyword rpiKeyword node
syntax keyword rpiKeyword nor
syntax keyword rpiKeyword not
syntax keyword rpiKeyword or
syntax keyword rpiKeyword pre
syntax keyword rpiType real
syntax keyword rpiKeyword returns
syntax keyword rpiKeyword struct
syntax keyword rpiKeyword tel
syntax keyword rpiKeyword then
syntax keyword rpiBoolean true
syntax keyword rpiKeyword type
syntax keyword rpiKeyword unsafe
syntax keyword rpiKeyword var
syntax keyword rpiKeyword when
syntax keyword rpiKeyword with
syntax keyword rpiKeyword xor
syntax match rpiKeyword /\.\@1<!\<activate\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<assume\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<check\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<con\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<contract\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<default\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<ensure\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<every\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<guarantee\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<import\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<imported\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<include\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<initial\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<mode\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<noc\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<of\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<require\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<restart\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<step\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<command\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<device\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<fragment\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<frame\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<primitive\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<task\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<test\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<use\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<automaton\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<export\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<fail\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<finish\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<parallel\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<repeat\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<start\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<state\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<yield\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<actuator\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<last\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<sensor\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<status\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<budget\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<continue\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<given\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<in\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<on\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<times\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<end\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<unless\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<until\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<otherwise\>\(\s*[=:,)]\)\@!/
syntax match rpiOperator /->\|??\|<>\|<=\|>=\|[-+*\/%^|#=<>?]/
syntax match rpiNumber /\<\d\+\(\.\d*\)\?\([eE][-+]\?\d\+\)\?\>\?/
syntax match rpiNumber /\<0[xX]\x\+\>/
syntax match rpiUnit /\(\d\|\<real\)\@<=\[[^\]]*\]/
syntax match rpiComment /--.*$/
syntax match rpiDoc /--|.*$/
syntax region rpiComment start=/(\*/ end=/\*)/
syntax region rpiString start=/"/ skip=/\\./ end=/"\|$/

highlight default link rpiBoolean Boolean
highlight default link rpiComment Comment
highlight default link rpiDoc SpecialComment
highlight default link rpiKeyword Keyword
highlight default link rpiNumber Number
highlight default link rpiOperator Operator
highlight default link rpiString String
highlight default link rpiType Type
highlight default link rpiUnit Special

let b:current_syntax = "rpi"
