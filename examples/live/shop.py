"""A small web shop on this machine, for `web.py` to explore. `python shop.py` serves it until Ctrl-C.

Two things are wrong with it, and on purpose. The link "Returns" of the help page is dead. The link "My account" leads
to the account once; from the second visit on the shop has forgotten who you are, and it leads to the login.
"""

import http.server
import threading

# By path: the title, and the links. Each page links to the first one, too.
PAGES = {
    "/": (
        "Toys and books",
        {"Toys": "/toys", "Books": "/books", "Cart": "/cart", "Help": "/help", "My account": "/my"},
    ),
    "/toys": ("Toys", {"A kite": "/toys/kite", "A robot": "/toys/robot"}),
    "/toys/kite": ("A kite", {"Add to cart": "/cart", "Other toys": "/toys"}),
    "/toys/robot": ("A robot", {"Add to cart": "/cart", "Other toys": "/toys"}),
    "/books": ("Books", {"An atlas": "/books/atlas"}),
    "/books/atlas": ("An atlas", {"Add to cart": "/cart"}),
    "/cart": ("Cart", {"Checkout": "/checkout"}),
    "/checkout": ("Checkout", {"Buy": "/thanks", "Cart": "/cart"}),
    "/thanks": ("Thank you", {}),
    "/help": ("Help", {"Shipping": "/help/shipping", "Returns": "/help/returns"}),
    "/help/shipping": ("Shipping", {"Help": "/help"}),
    "/account": ("My account", {"Orders": "/orders"}),
    "/orders": ("Orders", {}),
    "/login": ("Login", {"Log in": "/account"}),
}


class Shop(http.server.ThreadingHTTPServer):
    """Listens on a free port of this machine alone."""

    def __init__(self):
        super().__init__(("127.0.0.1", 0), Pages)
        self.url = f"http://127.0.0.1:{self.server_port}/"
        self.account_was_seen = False

    def start(self):
        """Serves in the background; gives the address."""
        threading.Thread(target=self.serve_forever, daemon=True).start()
        return self.url


class Pages(http.server.BaseHTTPRequestHandler):
    def do_GET(self):
        if self.path == "/my":
            self.send_response(302)
            self.send_header("Location", "/login" if self.server.account_was_seen else "/account")
            self.send_header("Content-Length", "0")
            self.end_headers()
            self.server.account_was_seen = True
            return
        title, links = PAGES.get(self.path, ("Not found", {}))
        page = f"<!doctype html><title>{title}</title><h1>{title}</h1>"
        for text, path in {"Home": "/", **links}.items():
            page += f'<p><a href="{path}">{text}</a>'
        self.send_response(200 if self.path in PAGES else 404)
        self.send_header("Content-Type", "text/html; charset=utf-8")
        self.send_header("Content-Length", str(len(page)))
        self.end_headers()
        self.wfile.write(page.encode())

    def log_message(self, *_):
        pass


if __name__ == "__main__":
    shop = Shop()
    print(shop.url, flush=True)
    try:
        shop.serve_forever()
    except KeyboardInterrupt:
        pass
