"""``shipid completion``: the script that completes commands, options, models, ships, manoeuvres and files in a shell."""

from __future__ import annotations

import click

from shipid.foundation.exit_codes import ExitCode

#: Shell: the line that loads the script, for its own start file.
_LOADED = {
    "bash": 'eval "$(shipid completion bash)"   # in ~/.bashrc',
    "zsh": 'eval "$(shipid completion zsh)"   # in ~/.zshrc, after compinit',
    "fish": "shipid completion fish | source   # in ~/.config/fish/config.fish",
}


@click.command()
@click.argument("shell", type=click.Choice(list(_LOADED)))
def completion(shell: str) -> ExitCode:
    """Print the script by which a shell completes shipid: commands, options, models, ships, manoeuvres and files.

    \b
    eval "$(shipid completion bash)"        in ~/.bashrc
    eval "$(shipid completion zsh)"         in ~/.zshrc, after compinit
    shipid completion fish | source         in ~/.config/fish/config.fish
    """  # noqa: D301 - the escape is click's mark for text that is not rewrapped
    from click.shell_completion import get_completion_class

    found = get_completion_class(shell)
    assert found is not None
    root = click.get_current_context().find_root()
    script = found(root.command, {}, "shipid", "_SHIPID_COMPLETE")
    # The source alone: click's own check of the version starts a shell.
    click.echo(script.source_template % script.source_vars())
    if shell == "bash":
        # A colon ends a word in bash, and 'zigzag:20/20', 'nmea:udp:10110' and 'plan.rtz:main' are one.
        click.echo("COMP_WORDBREAKS=${COMP_WORDBREAKS//:/}")
    return ExitCode.DONE
