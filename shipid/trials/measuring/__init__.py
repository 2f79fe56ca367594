"""What a zig-zag or a turning circle measures."""
