#!/usr/bin/env python3
"""check_forwarding.py [ROOT]: every virtual function of EquationsOfMotion is overridden in ForwardingEquations.

A new one with a default would else be the default's in every wrapper, without a word from the compiler. `--self-test`
takes one away and expects that exactly this is found."""
import pathlib, re, sys


def body(text, name):
    """What stands between the braces of a class."""
    begin = re.search(r'class ' + name + r'\b[^;{]*\{', text).end()
    depth, i = 1, begin
    while depth:
        depth += {'{': 1, '}': -1}.get(text[i], 0)
        i += 1
    return re.sub(r'//[^\n]*', '', text[begin:i - 1])


def missing(interface, forwarding):
    virtual = re.findall(r'virtual [^~;{(]*?(\w+)\(', body(interface, 'EquationsOfMotion'))
    overridden = set(re.findall(r'(\w+)\([^{};]*\)[^{};]*\boverride\b', body(forwarding, 'ForwardingEquations')))
    return [name for name in virtual if name not in overridden]


arguments = sys.argv[1:]
self_test = '--self-test' in arguments
root = pathlib.Path(next((a for a in arguments if a[0] != '-'), pathlib.Path(__file__).parent.parent)) / 'core/plugin'
interface, forwarding = [(root / name).read_text() for name in ('equations.hpp', 'forwarding_equations.hpp')]
if self_test:
    for name in ('found_efforts', 'make_sensed_state', 'savings'):
        without = re.sub(r'\b' + name + r'\b', 'else_' + name, forwarding)
        assert missing(interface, without) == [name], name
found = missing(interface, forwarding)
for name in found:
    print(f'{root}/forwarding_equations.hpp: does not forward EquationsOfMotion::{name}')
sys.exit(1 if found else 0)
