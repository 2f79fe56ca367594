"""Other ships: where they go, how close they come, and how own ship keeps clear of them."""
