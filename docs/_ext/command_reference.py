"""`.. command-reference::`: commands and options of the program, from the code that parses them."""

from docutils import nodes
from docutils.parsers.rst import Directive
from tables import paragraph, section, table, words


def command_section(program, command):
    """The section of a command: what it does, its arguments and options, and its own commands."""
    context = command.context_class(command, info_name=program)
    usage = command.get_usage(context).removeprefix("Usage: ")
    content = [paragraph(text) for text in (command.help or "").split("\n\n") if text]
    content.append(nodes.literal_block(usage, usage, language="text"))
    records = [one.get_help_record(context) for one in command.params]
    rows = [[[nodes.literal("", left)], words(meaning)] for left, meaning in filter(None, records)]
    if rows:
        content.append(table(("argument or option", "meaning"), rows, (35, 65)))
    for name, inner in getattr(command, "commands", {}).items():
        content.append(command_section(f"{program} {name}", inner))
    return section([nodes.literal("", program)], nodes.make_id(program), *content)


class CommandReference(Directive):
    """The directive."""

    def run(self):
        """A section for each command."""
        from typer.main import get_command

        from cdem.cli import app

        commands = get_command(app).commands
        return [command_section(f"cdem {name}", command) for name, command in commands.items()]


def setup(app):
    """Called by Sphinx."""
    app.add_directive("command-reference", CommandReference)
    return {"parallel_read_safe": True}
