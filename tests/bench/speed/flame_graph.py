#!/usr/bin/env python3
"""Draws where a program's time goes, as a flame graph of few kilobytes:

    perf record -e cpu-clock -F 97 --call-graph dwarf,8192 parkade map LOG --rig RIG --out MAP --threads 1
    perf script -F comm,ip,sym,dso | flame_graph.py --title "..." > flame.svg

Width is time; what lies on a frame was called by it. Frames below --least of the whole are left out.
"""
import argparse
import html
import re
import sys

WIDTH, ROW = 1000, 17  # pixels


def stacks(lines):
    """Lists of function names, the outermost first, one per sample."""
    stack = []
    for line in lines:
        line = line.rstrip()
        if not line:
            if stack:
                yield stack[::-1]
            stack = []
        elif line[0].isspace():
            match = re.match(r"\s+[0-9a-f]+ (.*) \((.*)\)$", line)
            if match:
                stack.append(name_of(*match.groups()))
    if stack:
        yield stack[::-1]


def name_of(symbol, library):
    if symbol == "[unknown]":
        return re.sub(r"\.so.*", "", library.rsplit("/", 1)[-1])
    if "lambda" in symbol or "_M_invoke" in symbol:
        inner = re.search(r"parkade::([A-Za-z:]+)[(<]", symbol.replace("(anonymous namespace)::", ""))
        return inner.group(1) + " {...}" if inner else "{...}"
    symbol = re.sub(r"\(anonymous namespace\)::|parkade::", "", symbol)
    return re.sub(r"[(<].*", "", symbol) or symbol


class Frame:
    def __init__(self):
        self.samples, self.callees = 0, {}

    def add(self, stack):
        self.samples += 1
        if stack:
            self.callees.setdefault(stack[0], Frame()).add(stack[1:])


def draw(name, frame, begin, depth, scale, least, boxes):
    if frame.samples < least:
        return
    boxes.append((name, begin * scale, frame.samples * scale, depth, frame.samples))
    for callee in sorted(frame.callees):
        draw(callee, frame.callees[callee], begin, depth + 1, scale, least, boxes)
        begin += frame.callees[callee].samples


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--title", default="")
    parser.add_argument("--least", type=float, default=0.006, help="share of all samples")
    parser.add_argument("--from", dest="root", default="BuildMap", help="the function that stands at the bottom")
    arguments = parser.parse_args()
    whole = Frame()
    for stack in stacks(sys.stdin):
        if arguments.root in stack:
            whole.add(stack[stack.index(arguments.root) + 1:])
    if whole.samples == 0:
        sys.exit(f"no sample has {arguments.root}")
    boxes = []
    draw(arguments.root, whole, 0, 0, WIDTH / whole.samples, arguments.least * whole.samples, boxes)
    height = (max(box[3] for box in boxes) + 2) * ROW
    print(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" font-family="sans-serif" font-size="11">')
    print(f'<text x="4" y="12">{html.escape(arguments.title)}</text>')
    for name, x, width, depth, samples in boxes:
        y, text = height - (depth + 1) * ROW, html.escape(name)
        shade = 190 + sum(map(ord, name)) % 50
        print(f'<g><title>{text} {100 * samples / whole.samples:.1f} %</title><rect x="{x:.1f}" y="{y}" width="{max(width - 0.5, 0.5):.1f}"'
              f' height="{ROW - 1}" fill="rgb({shade + 15},{shade - 20},{120 + depth * 4 % 60})"/>')
        if width > 28:
            print(f'<text x="{x + 2:.1f}" y="{y + 12}">{html.escape(name[:int(width / 7)])}</text>')
        print('</g>')
    print('</svg>')


if __name__ == "__main__":
    main()
