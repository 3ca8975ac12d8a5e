// Options for slang's lint of Splatline's Verilog. The command is
//   $ slang --lint-only -f slang.f splatline_rgb24.v
//
// slang waives a kind as a whole. So three to six warnings of -Wwidth-trunc are left: a bit at an
// address that is not constant is the lowest bit of a shifted word. tests/flow/test_lint.py shows
// that nothing else is left.
-Wextra

// The target of such a case has its default value before the case, in the same block.
-Wno-case-incomplete
