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
syntax match rpiKeyword /\.\@1<!\<last\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<in\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<any\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<choose\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<datatype\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<exists\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<forall\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<match\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<opaque\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<provided\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<lsh\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<rsh\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<subtype\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<transparent\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<int8\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<int16\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<int32\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<int64\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<uint8\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<uint16\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<uint32\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<uint64\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<sint\>\(\s*[=:,)]\)\@!/
syntax match rpiKeyword /\.\@1<!\<uint\>\(\s*[=:,)]\)\@!/
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
